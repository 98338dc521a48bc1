// SPDX-License-Identifier: GPL-3.0-or-later
// Printers and print servers that the worker reaches. What a print server prints is stopped from here; a job that is open is handed to it.
import { useSignal } from '@preact/signals';
import { asJobError } from '../../../jobs/contract';
import type { BridgeMachine } from '../../../machines/links/bridge_link';
import { stopPrintServer, uploadGcode } from '../../../machines/printing/worker_tasks';
import { Button, toast } from '../../../ui';
import { safeFileName } from '../../../shared/session/download';
import { found } from '../bridge_machines';
import { ask } from './confirm';
import type { MachinesSession } from '../machines_session';

const kindWords = {
  printer: 'printer',
  octoprint: 'OctoPrint',
  moonraker: 'Moonraker',
  slicer: 'slicer',
  serial: 'cable',
  tcp: 'network',
  ruida: 'Ruida',
} as const;

export function OtherMachines({ session }: { readonly session: MachinesSession }) {
  const worker = session.services.connection.value?.state === 'ready';
  const others = found.value.filter(({ kind }) => kind !== 'serial' && kind !== 'tcp' && kind !== 'ruida');
  return (
    <section class="section" aria-label="Other machines">
      <h3>Other machines</h3>
      {others.length === 0 ? (
        <p class="hint">
          {worker
            ? 'None found. Printers of this computer appear by themselves; others are added with “formwright machine add”.'
            : 'Printers and network machines need the worker program: run “make run” in Formwright’s source and open the address it prints.'}
        </p>
      ) : (
        <ul class="other-machines">
          {others.map((machine) => (
            <OtherMachine key={machine.id} session={session} machine={machine} />
          ))}
        </ul>
      )}
    </section>
  );
}

function OtherMachine({ session, machine }: { session: MachinesSession; machine: BridgeMachine }) {
  const { name, kind, state } = machine;
  const server = kind === 'octoprint' || kind === 'moonraker';
  const printing = state === 'printing' || state === 'paused';
  return (
    <li>
      <i class={state === 'off' || state === 'stopped' ? 'dot off' : 'dot'} />
      <span class="clip">
        {name}, {kindWords[kind]}
      </span>
      <span>{state}</span>
      {server ? <SendJob session={session} machine={machine} /> : null}
      {server && printing ? (
        <Button size="small" kind="danger" onClick={() => void stop(session, machine)}>
          Stop the print
        </Button>
      ) : null}
    </li>
  );
}

async function stop(session: MachinesSession, { id, name }: BridgeMachine): Promise<void> {
  const { worker } = session.services;
  if (worker === null) return;
  try {
    await stopPrintServer(worker, id);
    toast(`${name} stops its print.`);
  } catch (thrown) {
    toast(asJobError(thrown).message, true);
  }
}

/** Only what was opened as a job: what is made here is for lasers and mills. */
function SendJob({ session, machine }: { session: MachinesSession; machine: BridgeMachine }) {
  const sending = useSignal(false);
  const { drawing } = session.document.value;
  const job = session.plan.value?.jobs[0]?.bytes;
  const { worker } = session.services;
  if (drawing?.kind !== 'job' || !job || worker === null) return null;
  const send = async (start: boolean) => {
    sending.value = true;
    try {
      await uploadGcode(worker, machine.id, job, `${safeFileName(session.title)}.gcode`, start);
      toast(
        start ? `${machine.name} is printing ${session.title}.` : `${session.title} is at ${machine.name}.`,
      );
    } catch (thrown) {
      toast(asJobError(thrown).message, true);
    } finally {
      sending.value = false;
    }
  };
  const confirm = () =>
    ask({
      title: `Start ${session.title} on ${machine.name}`,
      sentences: [
        'It heats up and moves as soon as it has the file. Is its bed clear, and is somebody beside it?',
      ],
      action: 'Send and start',
      danger: true,
      run: () => void send(true),
    });
  const busy = sending.value ? 'The file is being sent' : undefined;
  return (
    <>
      <Button size="small" disabledReason={busy} onClick={() => void send(false)}>
        Send
      </Button>
      <Button size="small" disabledReason={busy} onClick={confirm}>
        Send and start
      </Button>
    </>
  );
}
