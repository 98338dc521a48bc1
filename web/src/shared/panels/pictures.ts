// SPDX-License-Identifier: GPL-3.0-or-later
// Small pictures of the model and of results, drawn by the viewport with what it has on the graphics card
// already.
import type { ReadonlySignal, Signal } from '@preact/signals';
import { effect, useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import type { Report } from '../../jobs/contract';
import type { Viewpoint, Viewport } from '../../view';
import type { CraftDocument, CraftResult } from '../session/craft_document';
import type { ModelRoom } from '../session/opened_model';

export type Look = Pick<Viewpoint, 'direction' | 'up'>;
const pictureSize = { width: 144, height: 112 };

/** Once the viewport has been given what the session shows: that is another effect of the same change. */
async function pictureOf(view: Viewport, part: 'original' | 'relief', look: Look): Promise<Blob | null> {
  await Promise.resolve();
  return await view.pictureOf(part, look, pictureSize.width, pictureSize.height);
}

/** The model's picture as an address: the gallery's for a sample. `inViewport`: null until the viewport has the model. */
export function useModelPicture<D extends CraftDocument>(
  session: ModelRoom<D>,
  viewport: Signal<Viewport | null>,
  look: Look,
  inViewport?: ReadonlySignal<unknown>,
) {
  const url = useSignal<string | null>(null);
  useEffect(() => {
    let drawn: string | null = null;
    const show = (next: string) => {
      if (url.value?.startsWith('blob:')) URL.revokeObjectURL(url.value);
      url.value = next;
    };
    return effect(() => {
      const from = session.model.original.value?.from;
      const source = session.document.value.model?.source;
      const view = viewport.value;
      if (from === undefined || source === undefined || view === null || drawn === from) return;
      if (source.kind === 'file' && inViewport?.value === null) return;
      drawn = from;
      if (source.kind === 'sample') show(`pictures/${source.sample}.webp`);
      else
        void pictureOf(view, 'original', look).then(
          (blob) => void (blob && drawn === from && show(URL.createObjectURL(blob))),
          () => undefined,
        );
    });
  }, [session]);
  return url;
}

interface Shown {
  readonly kind: 'preview' | 'full';
  readonly report: Report;
}

/** A new result gets its picture as soon as it is shown. */
export function useResultPictures<D extends CraftDocument>(
  session: ModelRoom<D>,
  viewport: Signal<Viewport | null>,
  shown: ReadonlySignal<Shown | null>,
  look: (result: CraftResult, view: Viewport) => Look,
): void {
  useEffect(() => {
    const done = new Set<string>();
    return effect(() => {
      const result = session.result.value;
      const view = viewport.value;
      if (!result || result.picture || view === null || done.has(result.id)) return;
      if (shown.value?.kind !== 'full' || shown.value.report !== result.report) return;
      done.add(result.id);
      void pictureOf(view, 'relief', look(result, view)).then(
        (blob) => blob && session.keepPicture(result.id, blob),
        () => undefined,
      );
    });
  }, [session]);
}
