// SPDX-License-Identifier: GPL-3.0-or-later
import type { Signal } from '@preact/signals';
import { effect, useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { Button, Sheet } from '../../ui';
import type { Viewpoint, Viewport } from '../../view';
import { exportMain, Inspector } from './inspector';
import { viewpointOf } from './meshes';
import { Notes } from './notes';
import { solveInFull } from './full_solve';
import './relief.css';
import type { ReliefSession } from './relief_session';
import { ResultsStrip } from './results_strip';
import { mode, ViewportPanel } from './viewport_panel';

export interface ReliefPageProps {
  readonly session: ReliefSession;
  readonly onChooseFile: () => void;
  readonly onWorkerHelp: () => void;
  readonly onStart: () => void;
}

const pictureSize = { width: 144, height: 112 };
type Look = Pick<Viewpoint, 'direction' | 'up'>;
const threeQuarters: Look = { direction: [-0.5, -0.34, -1], up: [0, 1, 0] };

export function ReliefPage({ session, onChooseFile, onWorkerHelp, onStart }: ReliefPageProps) {
  const viewport = useSignal<Viewport | null>(null);
  const picture = useModelPicture(session, viewport);
  useResultPictures(session, viewport);
  useKeys(session, () => viewport.value);
  const { model } = session.document.value;
  return (
    <>
      <main class="view" aria-label="Relief">
        <h1 class="hidden-text">Relief</h1>
        <ViewportPanel
          session={session}
          onViewport={(made) => (viewport.value = made)}
          notes={<Notes session={session} onChooseFile={onChooseFile} onWorkerHelp={onWorkerHelp} />}
        >
          {model === null && session.activity.value.kind !== 'opening' ? (
            <div class="empty-view">
              <p>A relief starts from a model.</p>
              <div class="row">
                <Button kind="filled" icon="upload" onClick={onChooseFile}>
                  Open a model
                </Button>
                <Button onClick={onStart}>See the samples</Button>
              </div>
            </div>
          ) : null}
        </ViewportPanel>
      </main>
      {model ? (
        <Sheet label="Parameters">
          <Inspector
            session={session}
            viewport={viewport.value}
            picture={picture.value}
            onReplace={onChooseFile}
            onSolve={() => void solveInFull(session)}
          />
        </Sheet>
      ) : null}
      {model || session.activity.value.kind === 'opening' ? (
        <footer class="strip">
          <ResultsStrip session={session} />
        </footer>
      ) : null}
    </>
  );
}

/** Keys of this page: 0, F, S, Ctrl+Enter, Ctrl+E, Esc. */
function useKeys(session: ReliefSession, viewport: () => Viewport | null): void {
  useEffect(() => {
    const onKey = (event: KeyboardEvent) => {
      if (event.defaultPrevented || document.querySelector('dialog[open]')) return;
      const control = event.ctrlKey || event.metaKey;
      const typing = (event.target as Element).matches('input[type=text], select, textarea');
      const act = (action: () => void) => {
        event.preventDefault();
        action();
      };
      if (control && event.key === 'Enter') act(() => void solveInFull(session));
      else if (control && event.key.toLowerCase() === 'e') act(() => void exportMain(session));
      else if (event.key === 'Escape' && session.activity.value.kind !== 'idle') act(() => session.cancel());
      else if (control || event.altKey || typing) return;
      else if (event.key === '0') act(() => viewport()?.lookFromViewpoint(true));
      else if (event.key.toLowerCase() === 'f') act(() => viewport()?.fit(true));
      else if (event.key.toLowerCase() === 's')
        act(() => (mode.value = mode.value === 'swipe' ? 'relief' : 'swipe'));
    };
    document.addEventListener('keydown', onKey);
    return () => document.removeEventListener('keydown', onKey);
  }, [session]);
}

/** Once the viewport has been given what the session shows: that is another effect of the same change. */
async function pictureOf(view: Viewport, part: 'original' | 'relief', look: Look): Promise<Blob | null> {
  await Promise.resolve();
  return await view.pictureOf(part, look, pictureSize.width, pictureSize.height);
}

/** Pictures are drawn by the viewport, with what it has on the graphics card already. */
function useModelPicture(session: ReliefSession, viewport: Signal<Viewport | null>) {
  const url = useSignal<string | null>(null);
  useEffect(() => {
    let drawn: string | null = null;
    const show = (next: string) => {
      if (url.value?.startsWith('blob:')) URL.revokeObjectURL(url.value);
      url.value = next;
    };
    return effect(() => {
      const from = session.original.value?.from;
      const source = session.document.value.model?.source;
      const view = viewport.value;
      if (from === undefined || source === undefined || view === null || drawn === from) return;
      drawn = from;
      if (source.kind === 'sample') show(`pictures/${source.sample}.webp`);
      else
        void pictureOf(view, 'original', threeQuarters).then(
          (blob) => void (blob && drawn === from && show(URL.createObjectURL(blob))),
          () => undefined,
        );
    });
  }, [session]);
  return url;
}

/** A new result gets its picture as soon as it is shown. */
function useResultPictures(session: ReliefSession, viewport: Signal<Viewport | null>): void {
  useEffect(() => {
    const done = new Set<string>();
    return effect(() => {
      const result = session.result.value;
      const shown = session.shown.value;
      const view = viewport.value;
      if (!result || result.picture || view === null || shown?.kind !== 'full' || done.has(result.id)) return;
      if (shown.report !== result.report) return;
      done.add(result.id);
      const look = viewpointOf(result.report, 20) ?? view.getViewpoint();
      void pictureOf(view, 'relief', look).then(
        (blob) => blob && session.keepPicture(result.id, blob),
        () => undefined,
      );
    });
  }, [session]);
}
