// SPDX-License-Identifier: GPL-3.0-or-later
import { useEffect } from 'preact/hooks';
import { Gallery, KeptPicture } from '../shared/panels/gallery';
import type { Services } from '../shared/session/services';
import type { ReliefSession } from '../crafts/relief/relief_session';
import { warmUp } from '../crafts/relief/warm_up';
import { Button, Icon } from '../ui';
import { crafts } from './crafts';
import { LearnList } from './learn/learn_list';
import { go } from './route';
import { toastFailure } from './failure_toast';

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
    const begin = async () => {
      await services.projects.create();
      session.forest.show(false);
      go('relief');
      await session.model.openSample(sample, title);
    };
    toastFailure(begin());
  };
  return (
    <main class="view start" aria-label="Start">
      <div class="start-inner">
        <h1>What will you make?</h1>
        <p class="lead">Turn a 3D model into a relief, a coloured plastic shell or a zip-up soft toy.</p>
        <ul class="craft-cards">
          {crafts.slice(0, 4).map((craft) => (
            <li key={craft.place}>
              <a class="craft-card" href={`#/${craft.place}`}>
                <span class="craft-picture">
                  <KeptPicture name={`craft_${craft.place}`} />
                </span>
                <span class="craft-text">
                  <strong>{craft.title}</strong>
                  <span>{craft.pitch}</span>
                  <small>{craft.makes}</small>
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
        <h2>Learn by doing, ten minutes each</h2>
        <LearnList projects={services.projects} />
        {catalog && catalog.samples.length > 0 ? (
          <>
            <h2>Or start from a sample</h2>
            <Gallery samples={catalog.samples} onOpen={open} />
          </>
        ) : null}
        <p class="start-foot">
          Models stay on this machine. <a href="#/about">About Formwright and its licences</a>
        </p>
      </div>
    </main>
  );
}
