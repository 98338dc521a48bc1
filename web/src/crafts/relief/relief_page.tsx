// SPDX-License-Identifier: GPL-3.0-or-later
import { useSignal } from '@preact/signals';
import { Sheet } from '../../ui';
import type { Viewport } from '../../view';
import { ForestButton } from './forest/forest_button';
import { ForestPage } from './forest/forest_page';
import { exportMain, Inspector } from './inspector';
import { viewpointOf } from './meshes';
import { Notes } from './notes';
import { solveInFull } from '../../shared/session/full_solve';
import { useRoomKeys } from '../../shared/session/room_keys';
import { EmptyModelRoom } from '../../shared/panels/empty_room';
import '../../shared/panels/room.css';
import type { ReliefSession } from './relief_session';
import type { SendToMill } from './send_relief';
import type { Look } from '../../shared/panels/pictures';
import { useModelPicture, useResultPictures } from '../../shared/panels/pictures';
import { ResultsStrip } from './results_strip';
import { mode, ViewportPanel } from './viewport_panel';

export interface ReliefPageProps {
  readonly session: ReliefSession;
  readonly onChooseFile: () => void;
  readonly onWorkerHelp: () => void;
  readonly onSendToMill: SendToMill;
}

const threeQuarters: Look = { direction: [-0.5, -0.34, -1], up: [0, 1, 0] };

export function ReliefPage(props: ReliefPageProps) {
  const { forest } = props.session;
  return forest.open.value ? (
    <ForestPage session={forest} onChooseFile={props.onChooseFile} />
  ) : (
    <Relief {...props} />
  );
}

function Relief(props: ReliefPageProps) {
  const { session, onChooseFile, onWorkerHelp } = props;
  const viewport = useSignal<Viewport | null>(null);
  const picture = useModelPicture(session, viewport, threeQuarters);
  const { shown } = session;
  useResultPictures(
    session,
    viewport,
    shown,
    ({ report }, view) => viewpointOf(report, 20) ?? view.getViewpoint(),
  );
  useRoomKeys(session, () => ({
    solve: () => void solveInFull(session),
    save: () => void exportMain(session),
    plain: {
      0: () => viewport.value?.lookFromViewpoint(true),
      f: () => viewport.value?.fit(true),
      s: () => (mode.value = mode.value === 'swipe' ? 'relief' : 'swipe'),
    },
  }));
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
            <EmptyModelRoom
              session={session}
              what="A relief starts from a model. Drop one, or choose a sample."
              samples={session.services.catalog.value?.samples ?? []}
              onChooseFile={onChooseFile}
            >
              <ForestButton session={session} />
            </EmptyModelRoom>
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
            onSendToMill={props.onSendToMill}
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
