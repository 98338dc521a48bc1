// SPDX-License-Identifier: GPL-3.0-or-later
import type { Sample } from '../../jobs/contract';
import { usesOf } from './sample_uses';

/** Kept in public/pictures by scripts/draw_pictures.js; a sample newer than its picture goes without. */
export function KeptPicture({ name }: { name: string }) {
  const hide = (event: { currentTarget: HTMLImageElement }) => (event.currentTarget.hidden = true);
  return <img src={`pictures/${name}.webp`} alt="" decoding="async" onError={hide} />;
}

export interface GalleryProps {
  readonly samples: readonly Sample[];
  readonly onOpen: (sample: string, title: string) => void;
}

/** The built-in models to start from. */
export function Gallery({ samples, onOpen }: GalleryProps) {
  return (
    <ul class="gallery">
      {samples.map((sample) => (
        <li key={sample.name}>
          <button type="button" onClick={() => onOpen(sample.name, sample.title)}>
            <span class="gallery-picture">
              <KeptPicture name={sample.name} />
            </span>
            <strong>{sample.title}</strong>
            <small>{usesOf(sample)}</small>
          </button>
        </li>
      ))}
    </ul>
  );
}
