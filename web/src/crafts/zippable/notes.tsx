// SPDX-License-Identifier: GPL-3.0-or-later
// Notes at the foot of the viewport: what keeps the work from going on first, then a list.
import { Icon, useLasting } from '../../ui';
import { NoteList } from '../../shared/panels/note_list';
import { notesOf } from '../../shared/session/report_notes';
import { problemNote, repairsNote } from '../../shared/panels/room_notes';
import type { ZippableSession } from './zippable_session';

export interface NotesProps {
  readonly session: ZippableSession;
  readonly onChooseFile: () => void;
}

export function Notes({ session, onChooseFile }: NotesProps) {
  const solving = useLasting(session.activity.value.kind === 'solving');
  const { model } = session.document.value;
  const problem = problemNote(session, onChooseFile);
  if (problem) return problem;
  if (model === null) return null;
  if (solving && session.shown.value)
    return (
      <p class="label-chip">
        <Icon name="clock" small /> This is the preview. The ribbon of the whole model replaces it.
      </p>
    );
  const repairs = repairsNote(session);
  if (repairs) return repairs;
  return (
    <NoteList
      notes={notesOf(session.shown.value?.report ?? {}, 'notes')}
      title="What was decided automatically"
      urgent={false}
      onFix={({ fix }) => fix && session.setParameters(fix.parameters, fix.label)}
    />
  );
}
