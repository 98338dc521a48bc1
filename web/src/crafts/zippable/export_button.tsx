// SPDX-License-Identifier: GPL-3.0-or-later
// The one filled button: makes the ribbon of the whole model, then hands out its files.
import type { OutputDeclaration } from '../../jobs/contract';
import { Button, formatBytes, Icon, Menu } from '../../ui';
import { download, safeFileName } from '../../shared/session/download';
import { timeLine } from '../../shared/session/estimate';
import { outputOf, solveInFull } from '../../shared/session/full_solve';
import { howMadeItem } from '../../shared/session/how_made';
import { printOnPaper } from '../../shared/print/print_request';
import { readyWorker } from '../../shared/session/services';
import { planBytes, simulationBytes } from './make_product';
import type { SendToMachine } from './sheets/send_sheet';
import { sendSheet, sheetCount, sheetName } from './sheets/send_sheet';
import { flatView } from './views';
import { design, planning, simulating } from './zippable_document';
import type { ZippableSession } from './zippable_session';

interface Export {
  readonly operation: string;
  readonly output: OutputDeclaration;
}

/** Made with the rig only. */
const rigFiles = ['rig.svg', 'rig.dxf', 'rig.pdf'];

/** In the order of the menu; a build offers those that its catalog names. */
const menu: readonly (readonly [operation: string, outputs: readonly string[]])[] = [
  [design, ['ribbon.svg']],
  [planning, ['plan.svg', 'plan.dxf', 'plan.pdf', 'sheets.zip', 'tape.pdf', 'assembly.pdf']],
  [planning, rigFiles],
  [simulating, ['zipped.ply', 'zipping.glb']],
  [design, ['design.json', 'parameterised.ply', 'formed.ply', 'curve.obj']],
];

/** First what belongs to what is shown. */
function exportsOf(session: ZippableSession): Export[] {
  const all = menu.flatMap(([operation, names]) => {
    const declared = session.operationNamed(operation)?.outputs ?? [];
    if (names === rigFiles && session.value('rig') !== true) return [];
    return names.flatMap((name) => {
      const output = declared.find((one) => one.name === name);
      return output ? [{ operation, output }] : [];
    });
  });
  const first = { ribbon: 'ribbon.svg', sheets: 'plan.svg', rig: 'rig.svg' }[flatView.value];
  const main = all.find(({ output }) => output.name === first);
  return main ? [main, ...all.filter((one) => one !== main)] : all;
}

async function save(session: ZippableSession, { operation, output }: Export): Promise<void> {
  const label = inSentence(output);
  const make = { [planning]: planBytes, [simulating]: simulationBytes }[operation] ?? outputOf;
  const bytes = await make(session, output.name, label);
  if (bytes) download(bytes, `${safeFileName(session.title)}-${output.name}`, output.media_type);
}

/** Made first where it is not there yet. */
export async function exportMain(session: ZippableSession): Promise<void> {
  if (session.result.value === null) await solveInFull(session);
  const [main] = exportsOf(session);
  if (main && session.result.value) await save(session, main);
}

/** On paper at true size. The plan's sheets are as large as the bed: they become pages; the others are pages already. */
const printables = [
  { label: 'Print the plan on paper', output: 'plan.svg', words: 'plan' },
  { label: 'Print the tape template', output: 'tape.pdf', words: 'tape template' },
  { label: 'Print the assembly sheet', output: 'assembly.pdf', words: 'assembly sheet' },
] as const;

async function printPlan(
  session: ZippableSession,
  { output, words }: { readonly output: string; readonly words: string },
): Promise<void> {
  const bytes = await planBytes(session, output, words);
  if (bytes) printOnPaper({ title: `the ${words} of ${session.title}`, fileName: output, bytes });
}

/** "Plan, SVG" says its format itself. */
const withFormat = (output: OutputDeclaration) =>
  output.label.includes(', ') ? output.label : `${output.label}, ${ending(output)}`;
const inSentence = ({ label }: OutputDeclaration) => label.charAt(0).toLowerCase() + label.slice(1);
const ending = ({ name }: OutputDeclaration) => name.split('.').at(-1)?.toUpperCase() ?? '';

export interface MainButtonProps {
  readonly session: ZippableSession;
  readonly onSolve: () => void;
  readonly onSendToMachine: SendToMachine;
}

export function MainButton({ session, onSolve, onSendToMachine }: MainButtonProps) {
  const activity = session.activity.value;
  if (activity.kind === 'solving')
    return (
      <>
        <Button kind="filled" size="big" disabledReason="The ribbon is being made; Esc cancels">
          Making the ribbon
        </Button>
        <p>Earlier results are kept. Esc cancels.</p>
      </>
    );
  const busy = activity.kind === 'idle' ? undefined : 'A file is being made or opened';
  const result = session.result.value;
  if (result === null)
    return (
      <>
        <Button
          kind="filled"
          size="big"
          disabledReason={session.shown.value === null ? 'Available when the preview is ready' : busy}
          onClick={onSolve}
        >
          Make the ribbon
        </Button>
        <p>{timeLine(session.estimate.value, readyWorker(session.services) !== null)}</p>
      </>
    );
  const all = exportsOf(session);
  const [main] = all;
  if (main === undefined) return null;
  const count = sheetCount(session);
  const sends = Array.from({ length: count }, (_, sheet) => ({
    label: count === 1 ? 'Send to a machine' : `Send ${sheetName(session, sheet).toLowerCase()} to a machine`,
    icon: 'machines' as const,
    disabledReason:
      busy ?? (session.operationNamed(planning) ? undefined : 'This version cannot make cutting plans'),
    onSelect: () => void sendSheet(session, sheet, onSendToMachine),
  }));
  const prints = session.operationNamed(planning)
    ? printables.map(({ label, ...what }) => ({
        label,
        icon: 'print' as const,
        disabledReason: busy,
        onSelect: () => void printPlan(session, what),
      }))
    : [];
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
          Export {inSentence(main.output)}
        </Button>
        <Menu
          label="Export something else"
          buttonClass="button filled big"
          align="right"
          items={[
            ...sends,
            ...prints,
            null,
            ...all.map((one) => {
              const { operation, output } = one;
              const from =
                { [planning]: session.plan, [simulating]: session.simulation }[operation]?.value ?? result;
              const bytes = from?.outputs[output.name]?.bytes;
              return {
                label: withFormat(output),
                hint: bytes === undefined ? undefined : formatBytes(bytes),
                disabledReason: busy,
                onSelect: () => void save(session, one),
              };
            }),
            howMadeItem(
              session.title,
              session.document.value.model,
              result,
              session.plan.value,
              session.simulation.value,
            ),
          ]}
        >
          <Icon name="chevronDown" small />
        </Menu>
      </div>
      <p>
        {ending(main.output)} at true size
        {main.operation === planning
          ? ', layers by colour: cut, mark, engrave.'
          : '. The ribbon may overlap itself; the sheets to cut do not.'}
      </p>
    </>
  );
}
