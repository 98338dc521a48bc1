// SPDX-License-Identifier: GPL-3.0-or-later
// From what was made to paper: printer, paper, how the pages lie over it, and the print itself. Without a printer, a PDF.
import { useEffect, useMemo } from 'preact/hooks';
import type { Printable } from './print_request';
import { asFile, PrintSession } from './print_session';
import { Button, Dialog, formatNumber, Icon, Parameter, withUnit } from '../../ui';
import { download, safeFileName } from '../session/download';
import { PagePreview } from './page_preview';
import { ParameterPanel } from '../panels/parameters/parameter_panel';
import './print_dialog.css';
import type { Services } from '../session/services';

export interface PrintDialogProps {
  readonly services: Services;
  readonly printable: Printable;
  readonly onClose: () => void;
}

const qualityTitles: Record<string, string> = { draft: 'Draft', normal: 'Normal', high: 'High' };

export function PrintDialog({ services, printable, onClose }: PrintDialogProps) {
  const session = useMemo(() => new PrintSession(services, printable), [printable]);
  useEffect(() => () => session.close(), [session]);
  const operation = session.ownOperation;
  return (
    <Dialog title={`Print ${printable.title}`} onClose={onClose} wide>
      <div class="print-dialog">
        <PagePreview session={session} />
        <div class="print-choices">
          <PrinterChoice session={session} />
          {session.chosen.value === asFile ? null : <PrinterWishes session={session} />}
          {operation ? (
            <ParameterPanel
              operation={operation}
              parameters={session.parameters.value}
              errors={session.fieldErrors.value}
              onPreview={(name, value) => session.setParameter(name, value)}
              onCommit={() => undefined}
              openGroups={session.chosen.value === asFile ? ['Pages', 'Size'] : ['Size']}
            />
          ) : null}
        </div>
      </div>
      <Foot session={session} />
    </Dialog>
  );
}

function PrinterChoice({ session }: { readonly session: PrintSession }) {
  const worker = session.services.connection.value?.state === 'ready';
  const printers = session.printers.value;
  const reasons = session.printer.value?.reasons ?? [];
  return (
    <section class="section" aria-label="Printer">
      <div class="field-line">
        <label for="print-printer">Printer</label>
        <select
          id="print-printer"
          class="select"
          value={session.chosen.value}
          onChange={(event) => void session.choose(event.currentTarget.value)}
        >
          {printers.map(({ id, name, state }) => (
            <option key={id} value={id}>
              {name}
              {state === 'off' ? ' (off)' : ''}
            </option>
          ))}
          <option value={asFile}>No printer: save a PDF</option>
        </select>
      </div>
      {printers.length === 0 ? (
        <p class="hint">
          {session.looking.value
            ? 'Looking for printers'
            : worker
              ? 'No printer was found. Printers of this computer and of the network appear here by themselves.'
              : 'Printing from here needs the worker program: run “make run” in Formwright’s source and open the address it prints. Or save the PDF and print it at 100 %, not fitted to the page.'}
        </p>
      ) : null}
      {reasons.length > 0 ? (
        <p class="hint warn">
          <Icon name="warn" small /> {session.printer.value?.name}: {reasons.join('; ')}.
        </p>
      ) : null}
    </section>
  );
}

/** Of a printer: its paper, how many and how well. */
function PrinterWishes({ session }: { readonly session: PrintSession }) {
  const printer = session.printer.value;
  const paper = session.paper.value;
  if (printer === null) return null;
  return (
    <section class="section" aria-label="Paper">
      {session.isPages ? null : (
        <div class="field-line">
          <label for="print-paper">Paper</label>
          <select
            id="print-paper"
            class="select"
            value={paper?.name ?? ''}
            onChange={(event) => (session.paperName.value = event.currentTarget.value)}
          >
            {session.papers.value.map(({ name, label, loaded }) => (
              <option key={name} value={name}>
                {label}
                {loaded ? '' : ', by hand'}
              </option>
            ))}
          </select>
        </div>
      )}
      {printer.qualities.length > 1 ? (
        <div class="field-line">
          <label for="print-quality">Quality</label>
          <select
            id="print-quality"
            class="select"
            value={session.quality.value}
            onChange={(event) => (session.quality.value = event.currentTarget.value)}
          >
            {printer.qualities.map((name) => (
              <option key={name} value={name}>
                {qualityTitles[name] ?? name}
              </option>
            ))}
          </select>
        </div>
      ) : null}
      <Parameter
        label="Copies"
        unit=""
        integer
        minimum={1}
        maximum={printer.max_copies}
        slider={null}
        defaultValue={1}
        value={session.copies.value}
        onPreview={(value) => (session.copies.value = value ?? 1)}
        onCommit={() => undefined}
      />
      {printer.scaling_can_be_off ? null : (
        <p class="hint">
          This printer does not guarantee to print at true size: measure the ruler on the first page.
        </p>
      )}
    </section>
  );
}

function Foot({ session }: { readonly session: PrintSession }) {
  const task = session.task.value;
  const laid = session.laid.value;
  const { title } = session.printable;
  const waits = laid === null || !session.isCurrent.value ? 'The pages are being laid out' : undefined;
  const toPrinter = session.chosen.value !== asFile;
  const refused =
    waits ??
    (session.printer.value === null
      ? 'The printer has not answered yet'
      : session.printer.value.accepting === false
        ? 'The printer takes no prints now'
        : task
          ? 'Printing'
          : undefined);
  const save = (
    <Button
      icon="download"
      kind={toPrinter ? 'outlined' : 'filled'}
      disabledReason={waits}
      onClick={() => laid && download(laid.pdf, `${safeFileName(title)}.pdf`, 'application/pdf')}
    >
      Save the PDF
    </Button>
  );
  return (
    <div class="print-foot">
      <div class="print-state" role="status">
        {task ? (
          <>
            <Icon name="clock" small /> {task.sentence}
          </>
        ) : session.problem.value ? null : session.done.value ? (
          <>
            <Icon name="check" small /> {session.done.value}
          </>
        ) : (
          pagesLine(session)
        )}
      </div>
      {session.problem.value ? (
        <p class="problem" role="alert">
          {session.problem.value}
        </p>
      ) : null}
      <div class="print-buttons">
        {task ? <Button onClick={() => session.cancelPrint()}>Cancel the print</Button> : save}
        {toPrinter ? (
          <Button kind="filled" icon="print" disabledReason={refused} onClick={() => void session.print()}>
            Print
          </Button>
        ) : null}
      </div>
    </div>
  );
}

/** "2 pages, 297 × 210 mm, at true size". */
function pagesLine(session: PrintSession): string {
  const laid = session.laid.value;
  if (laid === null) return 'Laying out the pages';
  const { layout } = laid;
  if (layout === null) return 'Pages at true size, unchanged';
  const [width, height] = layout.size_mm;
  return [
    layout.pages === 1 ? '1 page' : `${layout.pages} pages, ${layout.columns} × ${layout.rows}`,
    `${withUnit(`${formatNumber(width, 4)} × ${formatNumber(height, 4)}`, 'mm')} at true size`,
    ...laid.notes,
  ].join('. ');
}
