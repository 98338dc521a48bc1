// SPDX-License-Identifier: GPL-3.0-or-later
import { useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { Button, Sheet } from '../../ui';
import type { Viewport } from '../../view';
import { exportMain, Inspector } from './inspector';
import { viewpointOf } from './meshes';
import { Notes } from './notes';
import { solveInFull } from '../common/full_solve';
import '../common/room.css';
import type { ReliefSession } from './relief_session';
import type { Look } from '../common/pictures';
import { useModelPicture, useResultPictures } from '../common/pictures';
import { ResultsStrip } from './results_strip';
import { mode, ViewportPanel } from './viewport_panel';

export interface ReliefPageProps {
  readonly session: ReliefSession;
  readonly onChooseFile: () => void;
  readonly onWorkerHelp: () => void;
  readonly onStart: () => void;
}

const threeQuarters: Look = { direction: [-0.5, -0.34, -1], up: [0, 1, 0] };

export function ReliefPage({ session, onChooseFile, onWorkerHelp, onStart }: ReliefPageProps) {
  const viewport = useSignal<Viewport | null>(null);
  const picture = useModelPicture(session, viewport, threeQuarters);
  const { shown } = session;
  useResultPictures(
    session,
    viewport,
    shown,
    ({ report }, view) => viewpointOf(report, 20) ?? view.getViewpoint(),
  );
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
