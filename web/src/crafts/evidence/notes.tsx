// SPDX-License-Identifier: GPL-3.0-or-later
// Notes at the foot of the room: what went wrong, or what is still missing.
import { Button, Note } from '../../ui';
import { evidence } from './evidence_document';
import type { EvidenceSession } from './evidence_session';
import { missingFrom } from './objects/measured_files';

export interface NotesProps {
  readonly session: EvidenceSession;
  readonly onChooseFile: () => void;
}

export function Notes({ session, onChooseFile }: NotesProps) {
  const problem = session.problem.value;
  const { draft } = session.document.value;
  const choose = (
    <Button size="small" onClick={onChooseFile}>
      Choose files
    </Button>
  );
  if (problem)
    return (
      <div class="evidence-note">
        <Note
          kind="bad"
          icon={problem.kind === 'file' ? 'file' : 'warn'}
          title={problem.title}
          onDismiss={() => (session.problem.value = null)}
          actions={choose}
        >
          {problem.message}
        </Note>
      </div>
    );
  if (draft)
    return (
      <div class="evidence-note">
        <Note
          kind="attention"
          icon="file"
          title={`Still missing: ${missingFrom(draft.files)}`}
          onDismiss={() =>
            session.services.projects.do(evidence.setDraft(null, 'Remove the incomplete files'))
          }
          actions={choose}
        >
          A measured object consists of mould.obj, setup.json and measured.csv. These files are kept until the
          missing ones are added.
        </Note>
      </div>
    );
  return null;
}
