// SPDX-License-Identifier: GPL-3.0-or-later
// What the core says of the scene or of what was made; else what the colours of the plan mean.
import { Button, Icon, Note } from '../../../ui';
import { NoteList } from '../../../shared/panels/note_list';
import { notesOf } from '../../../shared/session/report_notes';
import { makeForest } from './forest_inspector';
import type { ForestSession } from './forest_session';
import type { ForestView } from './views';

export function ForestNotes({ session, view }: { session: ForestSession; view: ForestView }) {
  const problem = session.problem.value;
  if (problem)
    return (
      <div class="note-place">
        <Note
          kind="bad"
          icon={problem.kind === 'file' ? 'file' : 'warn'}
          title={problem.title}
          onDismiss={() => (session.problem.value = null)}
          actions={
            problem.kind === 'solve' ? (
              <Button size="small" onClick={() => void makeForest(session)}>
                Try again
              </Button>
            ) : null
          }
        >
          {problem.message}
        </Note>
      </div>
    );
  const refused = session.plan.problem.value ?? Object.values(session.fieldErrors.value)[0];
  if (refused)
    return (
      <div class="note-place">
        <Note kind="attention" icon="warn" title="This forest cannot be made as it stands">
          {refused}
        </Note>
      </div>
    );
  const result = session.result.value;
  if (view === 'plan') return <PlanWords session={session} />;
  if (result === null)
    return (
      <p class="label-chip">
        <Icon name="clock" small /> This is the forest made before your changes.
      </p>
    );
  return (
    <NoteList
      notes={notesOf(result.report, 'notes')}
      title="Before you make it"
      urgent={view === 'space'}
      onFix={({ fix }) => fix && session.setParameters(fix.parameters, fix.label)}
    />
  );
}

function PlanWords({ session }: { session: ForestSession }) {
  const planned = session.plan.planned.value;
  if (planned === null)
    return (
      <p class="label-chip">
        <Icon name="clock" small /> Looking at the pillars
      </p>
    );
  const shared = planned.plan.shared.length;
  return (
    <p class="label-chip plan-words">
      {shared > 0
        ? `Coloured: what one viewpoint sees and gets. Striped: seen from two, on ${counted(new Set(planned.plan.shared.map(({ pillar }) => pillar)).size)}. Grey: bare.`
        : 'Coloured: what one viewpoint sees and gets. Grey: bare. Nothing is seen from two.'}
    </p>
  );
}

const counted = (pillars: number) => (pillars === 1 ? '1 pillar' : `${pillars} pillars`);
