// SPDX-License-Identifier: GPL-3.0-or-later
// Notes at the foot of the viewport: what keeps the work from going on first, then a list.
import { Button, formatNumber, Icon, Note, useLasting, withUnit } from '../../ui';
import { narrow } from '../../shared/panels/narrow';
import { NoteList } from '../../shared/panels/note_list';
import type { ReportNote } from '../../shared/session/report_notes';
import { notesOf } from '../../shared/session/report_notes';
import { problemNote, repairsNote } from '../../shared/panels/room_notes';
import { clampOf, placementNow } from './draw_scene';
import { beyondOpening, boxOf, placed, shareThatFits, sizeBeforeTurning_mm } from './placement';
import type { ThermoformSession } from './thermoform_session';
import { view } from './views';

/** How far the model reaches beyond the clamp, mm; 0 inside. */
function overhang_mm(session: ThermoformSession): number {
  const original = session.model.original.value;
  const shown = session.shown.value;
  const placement = placementNow(session);
  if (original === null || shown === null || placement === null) return 0;
  return beyondOpening(boxOf(placed(original.mesh.positions, placement)), clampOf(session, shown).opening_mm);
}

/** Moves the model to the middle and, where that is not enough, makes it as large as the opening allows. */
function makeFit(session: ThermoformSession): void {
  const original = session.model.original.value;
  const shown = session.shown.value;
  const placement = placementNow(session);
  if (original === null || shown === null || placement === null) return;
  const { low, high } = boxOf(placed(original.mesh.positions, placement));
  const share = shareThatFits({ low, high }, clampOf(session, shown).opening_mm);
  const size_mm = Math.floor(share * sizeBeforeTurning_mm(placement, boxOf(original.mesh.positions)));
  session.setParameters({ x_mm: 0, y_mm: 0, ...(share < 1 ? { size_mm } : {}) }, 'Make the model fit');
}

/** What the reports say that a maker should know before heating a sheet. */
function advice(session: ThermoformSession): ReportNote[] {
  const shown = session.shown.value;
  const [print, mould] = [session.print.value?.report ?? {}, session.mould.value?.report ?? {}];
  const of = {
    texture: notesOf(print, 'sentences'),
    undercut: notesOf(mould, 'advice'),
    thickness: [],
    stretch: [],
  }[view.value];
  return [...of, ...(shown ? notesOf(shown.report, 'warnings', 'notes') : [])];
}

export interface NotesProps {
  readonly session: ThermoformSession;
  readonly onChooseFile: () => void;
}

export function Notes({ session, onChooseFile }: NotesProps) {
  const solving = useLasting(session.activity.value.kind === 'solving');
  const { model } = session.document.value;
  const problem = problemNote(session, onChooseFile);
  if (problem) return problem;
  if (model === null) return null;
  const over = overhang_mm(session);
  if (over > 0.05)
    return (
      <div class="note-place">
        <Note
          kind="attention"
          icon="warn"
          title={`The model reaches ${withUnit(formatNumber(over, 2), 'mm')} beyond the clamp`}
          actions={
            <Button size="small" onClick={() => makeFit(session)}>
              Make it fit
            </Button>
          }
        >
          Move the model inwards or make it smaller, so that the clamp frame can close.
        </Note>
      </div>
    );
  if (solving && session.shown.value)
    return (
      <p class="label-chip">
        <Icon name="clock" small /> This is the preview. The sheet formed at full detail replaces it.
      </p>
    );
  const repairs = narrow() ? null : repairsNote(session);
  if (repairs) return repairs;
  return (
    <NoteList
      notes={advice(session)}
      title="Before you heat a sheet"
      urgent
      onFix={({ fix }) => fix && session.setParameters(fix.parameters, fix.label)}
    />
  );
}
