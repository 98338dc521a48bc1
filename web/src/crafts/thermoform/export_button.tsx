// SPDX-License-Identifier: GPL-3.0-or-later
// The one filled button: forms the sheet at full detail, then hands out what is made of it.
import type { OutputDeclaration } from '../../jobs/contract';
import { Button, formatBytes, Icon, Menu } from '../../ui';
import { download, safeFileName } from '../../shared/session/download';
import { printInPlastic, printOnPaper } from '../../shared/print/print_request';
import { timeLine } from '../../shared/session/estimate';
import { howMadeItem } from '../../shared/session/how_made';
import { figure } from '../../shared/session/report';
import { readyWorker } from '../../shared/session/services';
import { bytesToSave } from './make_product';
import { moulding, printing, simulate } from './thermoform_document';
import type { ThermoformSession } from './thermoform_session';

interface Export {
  readonly operation: string;
  readonly output: OutputDeclaration;
}

/** In the order of the menu; a build offers those that its catalog names. */
const menu: readonly (readonly [operation: string, output: string])[] = [
  [printing, 'print.pdf'],
  [printing, 'print.png'],
  [printing, 'formed.glb'],
  [moulding, 'mould.stl'],
  [moulding, 'mould.3mf'],
  [moulding, 'draft.ply'],
  [simulate, 'sheet.ply'],
  [simulate, 'forming.glb'],
  [simulate, 'mould.obj'],
  [simulate, 'setup.json'],
];

function exportsOf(session: ThermoformSession): Export[] {
  return menu.flatMap(([operation, name]) => {
    const output = session.operationNamed(operation)?.outputs.find((declared) => declared.name === name);
    return output ? [{ operation, output }] : [];
  });
}

/** "Mould, STL", "Print for paper (PDF)". */
const named = ({ operation, output }: Export): string =>
  operation === moulding && output.name !== 'draft.ply'
    ? `Mould, ${output.label}`
    : `${output.label} (${output.name.split('.').at(-1)?.toUpperCase() ?? ''})`;

async function save(session: ThermoformSession, one: Export): Promise<void> {
  const bytes = await bytesToSave(session, one.operation, one.output.name, one.output.label);
  if (bytes) download(bytes, `${safeFileName(session.title)}-${one.output.name}`, one.output.media_type);
}

const offers = (session: ThermoformSession, operation: string, output: string): boolean =>
  session.operationNamed(operation)?.outputs.some(({ name }) => name === output) === true;

/** The picture at true size; its pages are laid out for the printer's own paper. */
async function printPicture(session: ThermoformSession): Promise<void> {
  const bytes = await bytesToSave(session, printing, 'print.png', 'print');
  if (bytes) printOnPaper({ title: `the picture of ${session.title}`, fileName: 'print.png', bytes });
}

async function printMould(session: ThermoformSession): Promise<void> {
  const bytes = await bytesToSave(session, moulding, 'mould.stl', 'mould');
  if (bytes) printInPlastic({ title: `the mould of ${session.title}`, fileName: 'mould.stl', bytes });
}

export async function exportMain(session: ThermoformSession): Promise<void> {
  const [main] = exportsOf(session);
  if (main) await save(session, main);
}

const keptBytes = (session: ThermoformSession, { operation, output }: Export): number | null => {
  const from = { [simulate]: session.result, [printing]: session.print, [moulding]: session.mould }[
    operation
  ];
  return from?.value?.outputs[output.name]?.bytes ?? null;
};

export function MainButton({ session, onForm }: { session: ThermoformSession; onForm: () => void }) {
  const activity = session.activity.value;
  if (activity.kind === 'solving')
    return (
      <>
        <Button kind="filled" size="big" disabledReason="The sheet is being formed; Esc cancels">
          Forming at full detail
        </Button>
        <p>Earlier results are kept. Esc cancels.</p>
      </>
    );
  const busy = activity.kind === 'idle' ? undefined : 'A file is being made or opened';
  if (session.result.value === null)
    return (
      <>
        <Button
          kind="filled"
          size="big"
          disabledReason={session.shown.value === null ? 'Available when the preview is ready' : busy}
          onClick={onForm}
        >
          Form at full detail
        </Button>
        <p>{timeLine(session.estimate.value, readyWorker(session.services) !== null)}</p>
      </>
    );
  const all = exportsOf(session);
  const [main] = all;
  if (main === undefined) return null;
  const size = keptBytes(session, main);
  const print = main.operation === printing;
  return (
    <>
      <div class="split">
        <Button
          kind="filled"
          size="big"
          icon={print ? 'print' : 'download'}
          disabledReason={busy}
          onClick={() => void save(session, main)}
        >
          {print ? 'Export print' : `Export ${main.output.label.toLowerCase()}`}
        </Button>
        <Menu
          label="Export something else"
          buttonClass="button filled big"
          align="right"
          items={[
            ...(offers(session, printing, 'print.png')
              ? [
                  {
                    label: 'Print the picture on paper',
                    icon: 'print' as const,
                    disabledReason: busy,
                    onSelect: () => void printPicture(session),
                  },
                ]
              : []),
            ...(offers(session, moulding, 'mould.stl')
              ? [
                  {
                    label: 'Send the mould to a 3D printer',
                    icon: 'machines' as const,
                    disabledReason: busy,
                    onSelect: () => void printMould(session),
                  },
                ]
              : []),
            null,
            ...all.map((one) => {
              const bytes = keptBytes(session, one);
              return {
                label: named(one),
                hint: bytes === null ? undefined : formatBytes(bytes),
                disabledReason: busy,
                onSelect: () => void save(session, one),
              };
            }),
            howMadeItem(
              session.title,
              session.document.value.model,
              session.result.value,
              session.print.value,
              session.mould.value,
            ),
          ]}
        >
          <Icon name="chevronDown" small />
        </Menu>
      </div>
      <p>
        {[print ? printLine(session) : null, size === null ? null : formatBytes(size)]
          .filter(Boolean)
          .join(', ') || 'This file is made when you export it'}
      </p>
    </>
  );
}

/** "PDF at true size, 300 dpi, 2 pages". */
function printLine(session: ThermoformSession): string {
  const pages = figure(session.print.value?.report ?? {}, 'pages');
  const dots = session.value('dots_per_inch');
  return [
    'PDF at true size',
    typeof dots === 'number' ? `${dots} dpi` : null,
    pages === null ? null : `${pages} ${pages === 1 ? 'page' : 'pages'}`,
  ]
    .filter(Boolean)
    .join(', ');
}
