// SPDX-License-Identifier: GPL-3.0-or-later
// Notes that every craft's page has at the foot of its viewport.
import { Button, Note } from '../../ui';
import { solveInFull } from '../session/full_solve';
import type { ModelRoom } from '../session/opened_model';
import { sentences } from '../session/report';

/** What went wrong, with the mend as a button; null where nothing did. */
export function problemNote(session: ModelRoom, onChooseFile: () => void) {
  const problem = session.problem.value;
  if (problem === null) return null;
  const ofFile = problem.kind === 'file';
  return (
    <div class="note-place">
      <Note
        kind="bad"
        icon={ofFile ? 'file' : 'warn'}
        title={problem.title}
        onDismiss={() => (session.problem.value = null)}
        actions={
          ofFile ? (
            <Button size="small" onClick={onChooseFile}>
              Choose another file
            </Button>
          ) : (
            <Button size="small" onClick={() => void solveInFull(session)}>
              Try again
            </Button>
          )
        }
      >
        {problem.message}
      </Note>
    </div>
  );
}

/** What was mended in the model just opened; null once dismissed. */
export function repairsNote(session: ModelRoom) {
  const { model } = session.document.value;
  if (!session.model.repairsOpen.value || model === null) return null;
  return (
    <div class="note-place">
      <Note
        kind="plain"
        icon="check"
        title="Repaired on import"
        onDismiss={() => (session.model.repairsOpen.value = false)}
      >
        {sentences(model.report, 'repairs').join(' ')}
      </Note>
    </div>
  );
}
