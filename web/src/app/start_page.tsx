// SPDX-License-Identifier: GPL-3.0-or-later
import { useEffect } from 'preact/hooks';
import type { Services } from '../crafts/common/services';
import type { ReliefSession } from '../crafts/relief/relief_session';
import { warmUp } from '../crafts/relief/warm_up';
import { Button, formatCount, Icon } from '../ui';
import { crafts, notYet } from './crafts';
import { go } from './route';

export interface StartPageProps {
  readonly services: Services;
  readonly session: ReliefSession;
  readonly onChooseFile: () => void;
}

/** Mesh formats as a person says them: "OBJ, STL, PLY, GLB or 3MF". */
export function formatNames(services: Services): string {
  const names = (services.catalog.value?.mesh_formats ?? []).map(({ extension }) => extension.toUpperCase());
  const last = names.pop();
  return names.length > 0 ? `${names.join(', ')} or ${last}` : (last ?? '');
}

/** Kept in public/pictures by scripts/draw_pictures.js; a sample newer than its picture goes without. */
function Picture({ name }: { name: string }) {
  const hide = (event: { currentTarget: HTMLImageElement }) => (event.currentTarget.hidden = true);
  return <img src={`pictures/${name}.webp`} alt="" decoding="async" onError={hide} />;
}

export function StartPage({ services, session, onChooseFile }: StartPageProps) {
  const catalog = services.catalog.value;
  useEffect(() => {
    if (catalog === null) return undefined;
    const abort = new AbortController();
    const timer = setTimeout(() => void warmUp(services, abort.signal), 300);
    return () => {
      clearTimeout(timer);
      abort.abort();
    };
  }, [catalog]);
  const open = (sample: string, title: string) => {
    go('relief');
    void services.projects.create().then(() => session.openSample(sample, title));
  };
  return (
    <main class="view start" aria-label="Start">
      <div class="start-inner">
        <h1>What will you make?</h1>
        <p class="lead">Turn a 3D model into something made by hand-sized machines.</p>
        <ul class="craft-cards">
          {crafts.slice(0, 4).map((craft) => (
            <li key={craft.place}>
              <a class={craft.available ? 'craft-card' : 'craft-card later'} href={`#/${craft.place}`}>
                <span class="craft-picture">
                  {craft.available ? <Picture name={`craft_${craft.place}`} /> : <Icon name={craft.icon} />}
                </span>
                <span class="craft-text">
                  <strong>{craft.title}</strong>
                  <span>{craft.pitch}</span>
                  <small>{craft.available ? craft.makes : notYet}</small>
                </span>
              </a>
            </li>
          ))}
        </ul>
        <div class="drop-line">
          <Icon name="upload" />
          <p class="grow">
            <strong>Drop a model anywhere</strong> {formatNames(services)}
          </p>
          <Button onClick={onChooseFile}>Open a file</Button>
        </div>
        {services.catalogError.value ? (
          <p class="start-error" role="alert">
            The solver could not be started: {services.catalogError.value} Reload the page to try again.
          </p>
        ) : null}
        {catalog && catalog.samples.length > 0 ? (
          <>
            <h2>Or start from a sample</h2>
            <ul class="gallery">
              {catalog.samples.map((sample) => (
                <li key={sample.name}>
                  <button type="button" onClick={() => open(sample.name, sample.title)}>
                    <span class="gallery-picture">
                      <Picture name={sample.name} />
                    </span>
                    <strong>{sample.title}</strong>
                    <small>{formatCount(sample.default_vertices / 1000)}k vertices</small>
                  </button>
                </li>
              ))}
            </ul>
          </>
        ) : null}
        <p class="start-foot">
          Models stay on this machine. <a href="#/about">About Formwright and its licences</a>
        </p>
      </div>
    </main>
  );
}
