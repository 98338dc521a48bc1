// SPDX-License-Identifier: GPL-3.0-or-later
import { effect, useSignal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import { Button, Sheet } from '../../ui';
import type { Viewport } from '../../view';
import { renderThumbnail } from '../../view';
import { exportMain, Inspector } from './inspector';
import { originalData, plateOf, reliefData, viewpointOf } from './meshes';
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

const pictureSize = { widthPx: 144, heightPx: 112 };

export function ReliefPage({ session, onChooseFile, onWorkerHelp, onStart }: ReliefPageProps) {
  const viewport = useSignal<Viewport | null>(null);
  const picture = useModelPicture(session);
  useResultPictures(session);
  useKeys(session, () => viewport.value);
  const { model } = session.document.value;
  return (
    <>
      <main class="view" aria-label="Relief">
        <h1 class="hidden-text">Relief</h1>
        <ViewportPanel session={session} onViewport={(made) => (viewport.value = made)}>
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
          <Notes session={session} onChooseFile={onChooseFile} onWorkerHelp={onWorkerHelp} />
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

/** A small picture of the model for the inspector. */
function useModelPicture(session: ReliefSession) {
  const url = useSignal<string | null>(null);
  const drawn = useRef<string | null>(null);
  useEffect(
    () =>
      effect(() => {
        const original = session.original.value;
        if (original === null || drawn.current === original.from) return;
        drawn.current = original.from;
        void renderThumbnail(originalData(original.mesh, 1), pictureSize, {
          ground: true,
        }).then(
          (blob) => {
            if (url.value) URL.revokeObjectURL(url.value);
            url.value = URL.createObjectURL(blob);
          },
          () => undefined,
        );
      }),
    [session],
  );
  return url;
}

/** A new result gets its picture as soon as it is shown. */
function useResultPictures(session: ReliefSession): void {
  const done = useRef(new Set<string>());
  useEffect(
    () =>
      effect(() => {
        const result = session.result.value;
        const shown = session.shown.value;
        if (!result || result.picture || shown?.kind !== 'full' || done.current.has(result.id)) return;
        if (shown.report !== result.report) return;
        done.current.add(result.id);
        const thickness = Number(session.value('thickness_mm') ?? 0);
        const plate = plateOf(result.report, thickness);
        const viewpoint = viewpointOf(result.report, 20);
        void renderThumbnail(reliefData(shown.mesh), pictureSize, {
          plate,
          ...(viewpoint ? { viewpoint } : {}),
        }).then(
          (blob) => session.keepPicture(result.id, blob),
          () => undefined,
        );
      }),
    [session],
  );
}
