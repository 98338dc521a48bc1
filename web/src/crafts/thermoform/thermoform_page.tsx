// SPDX-License-Identifier: GPL-3.0-or-later
import { useSignal } from '@preact/signals';
import { useEffect, useMemo } from 'preact/hooks';
import { Sheet } from '../../ui';
import type { Viewport } from '../../view';
import { solveInFull } from '../../shared/session/full_solve';
import { useRoomKeys } from '../../shared/session/room_keys';
import { EmptyModelRoom } from '../../shared/panels/empty_room';
import type { Look } from '../../shared/panels/pictures';
import { useModelPicture, useResultPictures } from '../../shared/panels/pictures';
import '../../shared/panels/room.css';
import { exportMain } from './export_button';
import { Inspector } from './inspector';
import { Notes } from './notes';
import { ResultsStrip } from './results_strip';
import './thermoform.css';
import { FaceTool } from './stand/face_tool';
import './stand/stand.css';
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
  const picture = useModelPicture(session, viewport, look, session.placement);
  useResultPictures(session, viewport, session.shown, () => look);
  useRoomKeys(session, () => ({
    solve: () => void solveInFull(session),
    save: () => void exportMain(session),
    space: () => togglePlay(session),
    plain: {
      0: () => viewport.value?.lookFromViewpoint(true),
      f: () => viewport.value?.fit(true),
      s: () => (swiping.value = !swiping.value),
    },
  }));
  const tool = useMemo(() => new FaceTool(session), [session]);
  useEffect(() => tool.watch(), [tool]);
  useEffect(() => () => void (playing.value = false), []);
  const { model } = session.document.value;
  const opening = session.activity.value.kind === 'opening';
  return (
    <>
      <main class="view" aria-label="Thermoform">
        <h1 class="hidden-text">Thermoform</h1>
        <ViewportPanel
          session={session}
          tool={tool}
          onViewport={(made) => (viewport.value = made)}
          notes={<Notes session={session} onChooseFile={onChooseFile} />}
        >
          {model === null && !opening ? (
            <EmptyModelRoom
              session={session}
              what="A shell starts from a model. Drop one together with its material and picture files, or choose a sample."
              samples={session.services.catalog.value?.samples ?? []}
              onChooseFile={onChooseFile}
            />
          ) : null}
        </ViewportPanel>
      </main>
      {model ? (
        <Sheet label="Parameters">
          <Inspector
            session={session}
            tool={tool}
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
