// SPDX-License-Identifier: GPL-3.0-or-later
// The one filled button: makes the ribbon of the whole model, then hands out its files.
import type { OutputDeclaration } from '../../jobs/contract';
import { Button, formatBytes, formatDuration, Icon, Menu } from '../../ui';
import { download, safeFileName } from '../common/download';
import { outputOf, solveInFull } from '../common/full_solve';
import { readyWorker } from '../common/services';
import type { ZippableSession } from './zippable_session';

/** In the order of the menu; a build offers those that its catalog names. */
const menu = ['ribbon.svg', 'design.json', 'parameterised.ply', 'formed.ply', 'curve.obj'];

function exportsOf(session: ZippableSession): OutputDeclaration[] {
  const declared = session.operation.value?.outputs ?? [];
  return menu.flatMap((name) => declared.find((output) => output.name === name) ?? []);
}

async function save(session: ZippableSession, output: OutputDeclaration): Promise<void> {
  const bytes = await outputOf(session, output.name, output.label.toLowerCase());
  if (bytes) download(bytes, `${safeFileName(session.title)}-${output.name}`, output.media_type);
}

/** Made first where it is not there yet. */
export async function exportMain(session: ZippableSession): Promise<void> {
  if (session.result.value === null) await solveInFull(session);
  const [main] = exportsOf(session);
  if (main && session.result.value) await save(session, main);
}

const ending = ({ name }: OutputDeclaration) => name.split('.').at(-1)?.toUpperCase() ?? '';

export function MainButton({ session, onSolve }: { session: ZippableSession; onSolve: () => void }) {
  const activity = session.activity.value;
  if (activity.kind === 'solving')
    return (
      <>
        <Button kind="filled" size="big" disabledReason="Being made; Esc cancels">
          Making the ribbon
        </Button>
        <p>Change anything to start again</p>
      </>
    );
  const busy = activity.kind === 'idle' ? undefined : 'Busy with a file';
  const result = session.result.value;
  if (result === null)
    return (
      <>
        <Button
          kind="filled"
          size="big"
          disabledReason={session.shown.value === null ? 'Ready when the preview is' : busy}
          onClick={onSolve}
        >
          Make the ribbon
        </Button>
        <p>{timeLine(session)}</p>
      </>
    );
  const all = exportsOf(session);
  const [main] = all;
  if (main === undefined) return null;
  return (
    <>
      <div class="split">
        <Button
          kind="filled"
          size="big"
          icon="download"
          disabledReason={busy}
          onClick={() => void save(session, main)}
        >
          Export {main.label.toLowerCase()}
        </Button>
        <Menu
          label="Export something else"
          buttonClass="button filled big"
          align="right"
          items={all.map((output) => {
            const bytes = result.outputs[output.name]?.bytes;
            return {
              label: `${output.label}, ${ending(output)}`,
              hint: bytes === undefined ? undefined : formatBytes(bytes),
              disabledReason: busy,
              onSelect: () => void save(session, output),
            };
          })}
        >
          <Icon name="chevronDown" small />
        </Menu>
      </div>
      <p>{ending(main)} at true size. It may overlap itself.</p>
    </>
  );
}

function timeLine(session: ZippableSession): string {
  const { browser_s, worker_s } = session.estimate.value;
  if (readyWorker(session.services) !== null)
    return worker_s ? `About ${formatDuration(worker_s)} with the worker` : 'With the native worker';
  return browser_s ? `About ${formatDuration(browser_s)} in the browser` : 'In the browser';
}
