// SPDX-License-Identifier: GPL-3.0-or-later
// Notes at the foot of the viewport: one at a time, the most urgent first.
import { useSignal } from '@preact/signals';
import { Button, formatDuration, Icon, Note, useLasting } from '../../ui';
import { narrow } from '../../shared/panels/narrow';
import { NoteList } from '../../shared/panels/note_list';
import { notesOf } from '../../shared/session/report_notes';
import { readyWorker } from '../../shared/session/services';
import { problemNote, repairsNote } from '../../shared/panels/room_notes';
import type { ReliefSession } from './relief_session';

const dismissedKey = 'formwright.relief.no-worker-note';
/** Below this a solve in the browser needs no words. */
const longSolve_s = 10;

export function Notes({ session, onChooseFile, onWorkerHelp }: NotesProps) {
  const dismissed = useSignal(sessionStorage.getItem(dismissedKey) !== null);
  const solving = useLasting(session.activity.value.kind === 'solving');
  const { model } = session.document.value;
  const problem = problemNote(session, onChooseFile);
  if (problem) return problem;
  if (solving && session.shown.value)
    return (
      <p class="label-chip">
        <Icon name="clock" small /> This is the preview. The relief at full detail replaces it.
      </p>
    );
  const repairs = repairsNote(session);
  if (repairs) return repairs;
  const estimate = session.estimate.value;
  const long = (estimate?.browser_s ?? 0) > longSolve_s;
  // No worker runs on a phone; the button says how long it will take.
  if (
    model &&
    long &&
    !narrow() &&
    !dismissed.value &&
    !session.result.value &&
    readyWorker(session.services) === null
  ) {
    const dismiss = () => {
      sessionStorage.setItem(dismissedKey, '1');
      dismissed.value = true;
    };
    return (
      <div class="note-place">
        <Note
          kind="attention"
          icon="clock"
          title="Solving takes a while in the browser"
          onDismiss={dismiss}
          actions={
            <>
              <Button size="small" onClick={onWorkerHelp}>
                How to start the worker program
              </Button>
              <Button size="small" kind="quiet" onClick={dismiss}>
                Keep working here
              </Button>
            </>
          }
        >
          At full detail this model takes about {formatDuration(estimate?.browser_s ?? 0)} in the browser
          {estimate?.worker_s
            ? ` and about ${formatDuration(estimate.worker_s)} in the worker program on your own computer`
            : '. The worker program on your own computer is several times faster'}
          . Previews run in the browser either way.
        </Note>
      </div>
    );
  }
  return (
    <NoteList
      notes={notesOf(session.shown.value?.report ?? {}, 'notes')}
      title="Before you make it"
      urgent
      onFix={({ fix }) => fix && session.setParameters(fix.parameters, fix.label)}
    />
  );
}

interface NotesProps {
  readonly session: ReliefSession;
  readonly onChooseFile: () => void;
  readonly onWorkerHelp: () => void;
}
