// SPDX-License-Identifier: GPL-3.0-or-later
// What is seen of a finished forest: the pictures from its viewpoints and from elsewhere, and the shares by rays.
import { useEffect, useState } from 'preact/hooks';
import { formatFixed, withUnit } from '../../../ui';
import { ZipReader } from '../../../project/zip_reader';
import type { ForestResult } from './forest_document';
import type { ForestSession } from './forest_session';
import type { ViewFigures } from './plan';
import { figuresOf } from './plan';
import { colourOf, modelName } from './views';

export interface ForestPicturesProps {
  readonly session: ForestSession;
  readonly result: ForestResult;
}

interface Picture {
  readonly name: string;
  readonly url: string;
}

/** Addresses of the pictures in `pictures.zip`, in its order, while they are shown. */
function usePictures(session: ForestSession, result: ForestResult): readonly Picture[] {
  const [pictures, setPictures] = useState<readonly Picture[]>([]);
  const reference = result.outputs['pictures.zip'];
  useEffect(() => {
    let made: Picture[] = [];
    let gone = false;
    const read = async () => {
      if (reference === undefined) return;
      const bytes = await session.services.projects.blobs.read(reference.blob);
      if (gone) return;
      const zip = new ZipReader(bytes, 'The file of the pictures');
      made = [...zip.entries.values()].map((entry) => ({
        name: entry.name,
        url: URL.createObjectURL(new Blob([zip.readNow(entry)], { type: 'image/png' })),
      }));
      setPictures(made);
    };
    read().catch(() => session.lose(result));
    return () => {
      gone = true;
      setPictures([]);
      for (const { url } of made) URL.revokeObjectURL(url);
    };
  }, [reference?.blob]);
  return pictures;
}

export function ForestPictures({ session, result }: ForestPicturesProps) {
  const pictures = usePictures(session, result);
  const scene = session.shownScene.value;
  const views = figuresOf(result.report, 'viewpoints').map((view, v) => {
    const viewpoint = scene?.viewpoints[v];
    return viewpoint ? { ...view, model: modelName(session, viewpoint) } : view;
  });
  return (
    <div class="forest-pictures" tabIndex={0} role="region" aria-label="Pictures and check">
      <ul>
        {pictures.map(({ name, url }, i) => (
          <li key={name}>
            <figure>
              <img src={url} alt={words(views[i], i)} />
              <figcaption>
                {views[i] ? <Disc index={i} /> : null}
                {words(views[i], i)}
              </figcaption>
            </figure>
          </li>
        ))}
      </ul>
      <Shares views={views} />
    </div>
  );
}

const words = (view: ViewFigures | undefined, index: number): string =>
  view ? `From viewpoint ${index + 1}: ${view.model}` : 'From elsewhere';

const Disc = ({ index }: { index: number }) => (
  <i class="number-disc" style={{ background: colourOf(index) }} aria-hidden="true">
    {index + 1}
  </i>
);

const columns = [
  ['seen_percent', 'Seen whole'],
  ['bare_percent', 'Bare surface'],
  ['no_pillar_percent', 'No pillar'],
  ['intrusion_percent', 'Other models'],
] as const;

function Shares({ views }: { views: readonly ViewFigures[] }) {
  return (
    <table>
      <caption>What the lines of sight to each model meet, by rays at the finished pillars</caption>
      <thead>
        <tr>
          <th scope="col">Model</th>
          {columns.map(([name, title]) => (
            <th key={name} scope="col">
              {title}
            </th>
          ))}
          <th scope="col">Pieces</th>
        </tr>
      </thead>
      <tbody>
        {views.map(({ model, shares }, v) => (
          <tr key={v}>
            <th scope="row">
              <Disc index={v} /> {model}
            </th>
            {columns.map(([name]) => (
              <td key={name}>{share(shares[name])}</td>
            ))}
            <td>{shares['pieces'] ?? '–'}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

const share = (percent: number | undefined): string =>
  percent === undefined ? '–' : withUnit(formatFixed(percent, percent === 0 ? 0 : 1), '%');
