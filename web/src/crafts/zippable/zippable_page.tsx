// SPDX-License-Identifier: GPL-3.0-or-later
import { useSignal } from '@preact/signals';
import { Sheet } from '../../ui';
import type { Viewport } from '../../view';
import { solveInFull } from '../../shared/session/full_solve';
import { useRoomKeys } from '../../shared/session/room_keys';
import { EmptyModelRoom } from '../../shared/panels/empty_room';
import { zippableSamples } from '../../shared/panels/sample_uses';
import { useModelPicture, useResultPictures } from '../../shared/panels/pictures';
import '../../shared/panels/room.css';
import { tool } from './drawing/draw_actions';
import { exportMain } from './export_button';
import { FlatRibbon } from './ribbon/flat_ribbon';
import { Inspector } from './inspector';
import { Notes } from './notes';
import { togglePlay } from './ribbon/play';
import { ResultsStrip } from './results_strip';
import type { SendToMachine } from './sheets/send_sheet';
import { flatView, view } from './views';
import { viewpoint, ViewportPanel } from './viewport_panel';
import './zippable.css';
import type { ZippableSession } from './zippable_session';

export interface ZippablePageProps {
  readonly session: ZippableSession;
  readonly onChooseFile: () => void;
  readonly onSendToMachine: SendToMachine;
}

export function ZippablePage({ session, onChooseFile, onSendToMachine }: ZippablePageProps) {
  const viewport = useSignal<Viewport | null>(null);
  const picture = useModelPicture(session, viewport, viewpoint);
  useResultPictures(session, viewport, session.shown, () => viewpoint);
  useRoomKeys(session, () => ({
    solve: () => void solveInFull(session),
    save: () => void exportMain(session),
    space: view.value === 'ribbon' ? togglePlay : undefined,
    plain: {
      0: () => viewport.value?.lookFromViewpoint(true),
      f: () => viewport.value?.fit(true),
    },
  }));
  const { model } = session.document.value;
  const zipped = view.value === 'ribbon' && flatView.value === 'ribbon' && session.shown.value !== null;
  const layout = tool.value ? 'drawing' : zipped ? 'zipped' : '';
  const opening = session.activity.value.kind === 'opening';
  const all = session.services.catalog.value?.samples ?? [];
  const samples = zippableSamples.flatMap((name) => all.find((sample) => sample.name === name) ?? []);
  return (
    <>
      <main class={`view zippable-view ${layout}`} aria-label="Zippable">
        <h1 class="hidden-text">Zippable</h1>
        <div class="zippable-model">
          <ViewportPanel
            session={session}
            onViewport={(made) => (viewport.value = made)}
            notes={<Notes session={session} onChooseFile={onChooseFile} />}
          />
        </div>
        <FlatRibbon session={session} onSendToMachine={onSendToMachine} />
        {model === null && !opening ? (
          <EmptyModelRoom
            session={session}
            what="A zippable starts from a closed model. Drop one, or choose a sample."
            samples={samples}
            onChooseFile={onChooseFile}
          />
        ) : null}
      </main>
      {model ? (
        <Sheet label="Parameters">
          <Inspector
            session={session}
            picture={picture.value}
            onReplace={onChooseFile}
            onSolve={() => void solveInFull(session)}
            onSendToMachine={onSendToMachine}
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
