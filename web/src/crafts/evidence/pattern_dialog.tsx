// SPDX-License-Identifier: GPL-3.0-or-later
// The pattern that a sheet is printed with before it is formed and scanned: on paper at true size, and its description beside it.
import { useSignal } from '@preact/signals';
import { useEffect, useMemo } from 'preact/hooks';
import type { Json, JsonObject, Operation } from '../../jobs/contract';
import { asJobError } from '../../jobs/contract';
import { Button, Dialog } from '../../ui';
import { withoutDefaults } from '../../shared/session/craft_document';
import { download } from '../../shared/session/download';
import { bytesOf } from '../../shared/session/import_model';
import { ParameterPanel } from '../../shared/panels/parameters/parameter_panel';
import { printOnPaper } from '../../shared/print/print_request';
import { readyWorker } from '../../shared/session/services';
import type { EvidenceSession } from './evidence_session';

const patterning = 'evidence-pattern';
/** The pages are laid out for the printer's own paper when it is printed. */
const laterGroup = 'Paper';

export function PatternButton({ session }: { readonly session: EvidenceSession }) {
  const open = useSignal(false);
  const operation = session.operationNamed(patterning);
  if (operation === undefined) return null;
  return (
    <>
      <Button kind="quiet" icon="print" onClick={() => (open.value = true)}>
        Print a pattern
      </Button>
      {open.value ? (
        <PatternDialog session={session} operation={operation} onClose={() => (open.value = false)} />
      ) : null}
    </>
  );
}

interface PatternDialogProps {
  readonly session: EvidenceSession;
  readonly operation: Operation;
  readonly onClose: () => void;
}

function PatternDialog({ session, operation, onClose }: PatternDialogProps) {
  const parameters = useSignal<JsonObject>({});
  const making = useSignal(false);
  const errors = useSignal<Readonly<Record<string, string>>>({});
  const problem = useSignal<string | null>(null);
  const abort = useMemo(() => new AbortController(), []);
  useEffect(() => () => abort.abort(), [abort]);
  const shown = useMemo(() => withoutGroup(operation, laterGroup), [operation]);
  const set = (name: string, value: Json) =>
    (parameters.value = withoutDefaults(operation, { ...parameters.value, [name]: value }));
  const print = async () => {
    making.value = true;
    errors.value = {};
    problem.value = null;
    try {
      const backend = readyWorker(session.services) ?? session.services.browser;
      const job = {
        operation: patterning,
        parameters: parameters.value,
        inputs: {},
        outputs: [
          'pattern.png',
          'pattern.json',
          ...(parameters.value['kind'] === 'marks' ? ['board.pdf'] : []),
        ],
      };
      const made = await backend.run(job, { signal: abort.signal });
      download(await bytesOf(made, 'pattern.json'), 'pattern.json', 'application/json');
      if (job.outputs.includes('board.pdf'))
        download(await bytesOf(made, 'board.pdf'), 'board.pdf', 'application/pdf');
      const bytes = await bytesOf(made, 'pattern.png');
      onClose();
      printOnPaper({ title: 'the pattern', fileName: 'pattern.png', bytes });
    } catch (thrown) {
      const { code, where, message } = asJobError(thrown);
      if (code === 'cancelled') return;
      if (shown.parameters.properties[where]) errors.value = { [where]: message };
      else problem.value = message;
    } finally {
      making.value = false;
    }
  };
  return (
    <Dialog title="Print a pattern" onClose={onClose}>
      <p>
        Print this pattern on a sheet and form it. A scan of it, or photographs if its kind is coded marks,
        then show where the points of the sheet moved. Keep pattern.json, which is saved with it and is needed
        then. With coded marks, board.pdf is saved too: the strips that lie around the sheet.
      </p>
      <div class="virtual-parameters">
        <ParameterPanel
          operation={shown}
          parameters={parameters.value}
          errors={errors.value}
          openGroups={['Sheet', 'Print']}
          onPreview={set}
          onCommit={() => undefined}
        />
      </div>
      {problem.value ? (
        <p class="problem" role="alert">
          {problem.value}
        </p>
      ) : null}
      <Button
        kind="filled"
        icon="print"
        disabledReason={making.value ? 'The pattern is being made' : undefined}
        onClick={() => void print()}
      >
        {making.value ? 'Making the pattern' : 'Save pattern.json and print'}
      </Button>
    </Dialog>
  );
}

function withoutGroup(operation: Operation, group: string): Operation {
  const kept = Object.entries(operation.parameters.properties).filter(
    ([, schema]) => schema['x-group'] !== group,
  );
  return { ...operation, parameters: { properties: Object.fromEntries(kept) } };
}
