// SPDX-License-Identifier: GPL-3.0-or-later
import { useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { Button, Sheet } from '../../ui';
import type { Viewport } from '../../view';
import { solveInFull } from '../common/full_solve';
import { Gallery } from '../common/gallery';
import type { Look } from '../common/pictures';
import { useModelPicture, useResultPictures } from '../common/pictures';
import '../common/room.css';
import { exportMain } from './export_button';
import { Inspector } from './inspector';
import { Notes } from './notes';
import { ResultsStrip } from './results_strip';
import './thermoform.css';
import type { ThermoformSession } from './thermoform_session';
import { togglePlay } from './timeline';
import { ViewportPanel } from './viewport_panel';
import { playing, swiping } from './views';

export interface ThermoformPageProps {
  readonly session: ThermoformSession;
  readonly onChooseFile: () => void;
}

const look: Look = { direction: [0.14, 0.95, -0.98], up: [0, 0, 1] };

export function ThermoformPage({ session, onChooseFile }: ThermoformPageProps) {
  const viewport = useSignal<Viewport | null>(null);
  const picture = useModelPicture(session, viewport, look);
  useResultPictures(session, viewport, session.shown, () => look);
  useKeys(session, () => viewport.value);
  useEffect(() => () => void (playing.value = false), []);
  const { model } = session.document.value;
  const opening = session.activity.value.kind === 'opening';
  return (
    <>
      <main class="view" aria-label="Thermoform">
        <h1 class="hidden-text">Thermoform</h1>
        <ViewportPanel
          session={session}
          onViewport={(made) => (viewport.value = made)}
          notes={<Notes session={session} onChooseFile={onChooseFile} />}
        >
          {model === null && !opening ? <Empty session={session} onChooseFile={onChooseFile} /> : null}
        </ViewportPanel>
      </main>
      {model ? (
        <Sheet label="Parameters">
          <Inspector
            session={session}
            picture={picture.value}
            onReplace={onChooseFile}
            onForm={() => void solveInFull(session)}
          />
        </Sheet>
      ) : null}
      {model || opening ? (
        <footer class="strip">
          <ResultsStrip session={session} />
        </footer>
      ) : null}
    </>
  );
}

function Empty({ session, onChooseFile }: ThermoformPageProps) {
  const samples = session.services.catalog.value?.samples ?? [];
  return (
    <div class="thermoform-empty">
      <p>A shell starts from a model. Drop one with its materials and pictures, or take a sample.</p>
      <Button kind="filled" icon="upload" onClick={onChooseFile}>
        Open a model
      </Button>
      <Gallery samples={samples} onOpen={(sample, title) => void session.openSample(sample, title)} />
    </div>
  );
}

/** Keys of this page: 0, F, S, Space, Ctrl+Enter, Ctrl+E, Esc. */
function useKeys(session: ThermoformSession, viewport: () => Viewport | null): void {
  useEffect(() => {
    const onKey = (event: KeyboardEvent) => {
      if (event.defaultPrevented || document.querySelector('dialog[open]')) return;
      const control = event.ctrlKey || event.metaKey;
      const target = event.target as Element;
      const typing = target.matches('input[type=text], select, textarea');
      const act = (action: () => void) => {
        event.preventDefault();
        action();
      };
      if (control && event.key === 'Enter') act(() => void solveInFull(session));
      else if (control && event.key.toLowerCase() === 'e') act(() => void exportMain(session));
      else if (event.key === 'Escape' && session.activity.value.kind !== 'idle') act(() => session.cancel());
      else if (control || event.altKey || typing) return;
      // Space presses what has the focus, where that can be pressed.
      else if (event.key === ' ' && !target.matches('button, a, input, [role=menuitem]'))
        act(() => togglePlay(session));
      else if (event.key === '0') act(() => viewport()?.lookFromViewpoint(true));
      else if (event.key.toLowerCase() === 'f') act(() => viewport()?.fit(true));
      else if (event.key.toLowerCase() === 's') act(() => (swiping.value = !swiping.value));
    };
    document.addEventListener('keydown', onKey);
    return () => document.removeEventListener('keydown', onKey);
  }, [session]);
}
