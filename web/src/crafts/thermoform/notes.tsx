// SPDX-License-Identifier: GPL-3.0-or-later
// Notes at the foot of the viewport: what keeps the work from going on first, then a list.
import type { JsonObject } from '../../jobs/contract';
import { Button, formatNumber, Icon, Note, useLasting, withUnit } from '../../ui';
import { narrow } from '../../shared/panels/narrow';
import { NoteList } from '../../shared/panels/note_list';
import type { ReportNote } from '../../shared/session/report_notes';
import { notesOf } from '../../shared/session/report_notes';
import { problemNote, repairsNote } from '../../shared/panels/room_notes';
import { fitting, roomIn } from './fit';
import { boxOf, clearance_mm, placed } from './placement';
import { margin_mm } from './stand/place_model';
import type { ThermoformSession } from './thermoform_session';
import { view } from './views';

/** How far the model is from the clamp, mm; negative where it reaches beyond. */
function clearanceOf(session: ThermoformSession): number {
  const original = session.model.original.value;
  const placement = session.placement.value;
  if (original === null || placement === null) return Infinity;
  return clearance_mm(boxOf(placed(original.mesh.positions, placement)), roomIn(session.inForce.value));
}

/** What makes the model fit; null while it is not known. */
function fitOf(session: ThermoformSession): JsonObject | null {
  const original = session.model.original.value;
  return original && fitting(session.inForce.value, original.mesh.positions);
}

const makeItFit = 'Make it fit';

/** A model that touches the clamp's edge, or all but touches it. */
function closeness(session: ThermoformSession, clear_mm: number): ReportNote[] {
  if (clear_mm > margin_mm - 0.05) return [];
  const parameters = fitOf(session);
  const distance = withUnit(formatNumber(Math.max(0, clear_mm), 2), 'mm');
  return [
    {
      sentence: `The model comes within ${distance} of the clamp: leave ${withUnit(String(margin_mm), 'mm')}, so that the sheet can be drawn down beside it.`,
      fix: parameters && { label: makeItFit, parameters },
    },
  ];
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
  const clear_mm = clearanceOf(session);
  if (clear_mm < -0.05)
    return (
      <div class="note-place">
        <Note
          kind="attention"
          icon="warn"
          title={`The model reaches ${withUnit(formatNumber(-clear_mm, 2), 'mm')} beyond the clamp`}
          actions={
            <Button
              size="small"
              onClick={() => session.setParameters(fitOf(session) ?? {}, 'Make the model fit')}
            >
              {makeItFit}
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
      notes={[...closeness(session, clear_mm), ...advice(session)]}
      title="Before you heat a sheet"
      urgent
      onFix={({ fix }) => fix && session.setParameters(fix.parameters, fix.label)}
    />
  );
}
