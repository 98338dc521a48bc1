// SPDX-License-Identifier: GPL-3.0-or-later
// Whether the project is saved. Where it is not: why, and the ways out.
import { useEffect, useState } from 'preact/hooks';
import type { ProjectStore, ProjectSummary } from '../../project/project_store';
import { Button, Dialog, toast } from '../../ui';
import { saveAsFile } from '../project_file';
import { sentenceOf } from '../failure_toast';

const words = { saved: 'Saved', saving: 'Saving', unsaved: 'Saving', failed: 'Not saved' } as const;

export function SaveState({ projects }: { projects: ProjectStore }) {
  const save = projects.saveState.value;
  const [shown, setShown] = useState(false);
  const failed = save.state === 'failed';
  if (projects.isBlank.value) return null;
  if (!projects.lasts) return <NotKept projects={projects} />;
  return (
    <>
      <span class={failed ? 'saved failed' : 'saved'} role="status">
        {failed ? (
          <button type="button" aria-haspopup="dialog" onClick={() => setShown(true)}>
            {words.failed}
          </button>
        ) : (
          words[save.state]
        )}
      </span>
      {shown ? <NotSaved projects={projects} onClose={() => setShown(false)} /> : null}
    </>
  );
}

/** No storage of the browser's can be written: the project ends with the tab. */
function NotKept({ projects }: { projects: ProjectStore }) {
  const [shown, setShown] = useState(false);
  const [problem, setProblem] = useState<string | null>(null);
  const save = () => {
    setProblem(null);
    saveAsFile(projects).catch((thrown: unknown) => setProblem(sentenceOf(thrown)));
  };
  return (
    <>
      <span class="saved failed">
        <button type="button" aria-haspopup="dialog" onClick={() => setShown(true)}>
          In this tab only
        </button>
      </span>
      {shown ? (
        <Dialog title="This project is kept only until the tab is closed" onClose={() => setShown(false)}>
          <p>
            This browser does not let the page keep files, as in a private window. Save the project as a file,
            and open that file later to continue.
          </p>
          {problem === null ? null : <p role="alert">{problem}</p>}
          <div class="row end">
            <Button kind="filled" onClick={save}>
              Save as a file
            </Button>
          </div>
        </Dialog>
      ) : null}
    </>
  );
}

function NotSaved({ projects, onClose }: { projects: ProjectStore; onClose: () => void }) {
  const save = projects.saveState.value;
  const { id: open } = projects.document.value;
  const [leaving, setLeaving] = useState<ProjectSummary | null>(null);
  const [problem, setProblem] = useState<string | null>(null);
  const others = projects.projects.value.filter(({ id }) => id !== open);
  useEffect(() => {
    if (save.state !== 'saved') return;
    toast('The project is saved.');
    onClose();
  }, [save.state]);
  // Told here: toasts lie under a dialog.
  const attempt = (work: Promise<void>) => {
    setProblem(null);
    work.catch((thrown: unknown) => setProblem(sentenceOf(thrown)));
  };
  const remove = (id: string) => {
    setLeaving(null);
    attempt(projects.remove(id));
  };
  return (
    <Dialog title="This project is not saved" onClose={onClose}>
      <p>{save.state === 'failed' ? save.message : 'Trying again.'}</p>
      {problem === null ? null : <p role="alert">{problem}</p>}
      <div class="row end">
        <Button onClick={() => attempt(saveAsFile(projects))}>Save as a file</Button>
        <Button kind="filled" onClick={() => attempt(projects.flush())}>
          Try again
        </Button>
      </div>
      {leaving ? (
        <>
          <p>Delete “{leaving.name}”? Its model, settings and results leave this browser.</p>
          <div class="row end">
            <Button onClick={() => setLeaving(null)}>Keep it</Button>
            <Button kind="danger" onClick={() => remove(leaving.id)}>
              Delete
            </Button>
          </div>
        </>
      ) : others.length > 0 ? (
        <>
          <h3>Make room</h3>
          <ul class="project-list">
            {others.map((other) => (
              <li key={other.id} class="row">
                <span class="grow clip">{other.name}</span>
                <Button size="small" onClick={() => setLeaving(other)}>
                  Delete<span class="hidden-text"> {other.name}</span>
                </Button>
              </li>
            ))}
          </ul>
        </>
      ) : null}
    </Dialog>
  );
}
