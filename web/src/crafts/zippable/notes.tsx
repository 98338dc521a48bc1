// SPDX-License-Identifier: GPL-3.0-or-later
// Notes at the foot of the viewport: one at a time, the most urgent first.
import { signal } from '@preact/signals';
import { Icon, Note, useLasting } from '../../ui';
import { sentences } from '../../shared/session/report';
import { problemNote, repairsNote } from '../../shared/panels/room_notes';
import type { ZippableSession } from './zippable_session';

/** Words that were read, until others come. */
const dismissed = signal('');
const open = signal(false);

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
  const said = sentences(session.shown.value?.report ?? {}, 'notes');
  const words = said.join(' ');
  if (said.length === 0 || words === dismissed.value) return null;
  if (!open.value)
    return (
      <button type="button" class="label-chip note-chip" onClick={() => (open.value = true)}>
        <Icon name="warn" small /> {said.length === 1 ? '1 note' : `${said.length} notes`}
      </button>
    );
  return (
    <div class="note-place">
      <Note
        kind="plain"
        icon="warn"
        title="What was decided automatically"
        onDismiss={() => {
          open.value = false;
          dismissed.value = words;
        }}
      >
        {words}
      </Note>
    </div>
  );
}
