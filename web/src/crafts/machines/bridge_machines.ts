// SPDX-License-Identifier: GPL-3.0-or-later
// The machines that the native worker reaches, asked for while the room is open.
import { effect, signal } from '@preact/signals';
import type { BridgeMachine } from '../../machines/links/bridge_link';
import { listBridgeMachines, openBridge } from '../../machines/links/bridge_link';
import type { MachineLink } from '../../machines/links/machine_link';
import { readMachine } from '../../machines/printing/worker_tasks';
import type { NativeConnection } from '../../jobs/native_connection';
import type { Json } from '../../jobs/contract';
import type { MachinesSession } from './machines_session';

export const found = signal<readonly BridgeMachine[]>([]);
const asking_ms = 5000;

/** Keeps the list up to date while the room is looked at and a worker is there. */
export function followBridge(session: MachinesSession): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  let over = false;
  const look = async () => {
    clearTimeout(timer);
    const { worker, connection } = session.services;
    if (worker && connection.value?.state === 'ready') await lookAt(worker).catch(() => undefined);
    else found.value = [];
    if (!over) timer = setTimeout(() => void look(), asking_ms);
  };
  const stop = effect(() => {
    void session.services.connection.value;
    void look();
  });
  return () => {
    over = true;
    clearTimeout(timer);
    stop();
  };
}

/** The list, then what print servers do now. Two are asked at a time: a browser has six connections to the worker, and while dead
 *  servers are waited for, a machine's stop must find one free. */
async function lookAt(worker: NativeConnection): Promise<void> {
  const known = new Map(found.peek().map(({ id, state }) => [id, state]));
  const listed = await listBridgeMachines(worker);
  const servers = listed.filter(({ kind }) => kind === 'octoprint' || kind === 'moonraker');
  found.value = listed.map((machine) =>
    servers.includes(machine) ? { ...machine, state: known.get(machine.id) ?? machine.state } : machine,
  );
  const askOn = async (): Promise<void> => {
    for (let server = servers.shift(); server !== undefined; server = servers.shift()) {
      const { id } = server;
      const state = await readMachine<{ state: string }>(worker, id).then(
        (answer) => answer.state,
        () => 'off',
      );
      found.value = found.peek().map((machine) => (machine.id === id ? { ...machine, state } : machine));
    }
  };
  await Promise.all([askOn(), askOn()]);
}

/** Those that a driver of this kind can talk to. */
export function bridgeMachines(session: MachinesSession, controller: Json | undefined) {
  const { worker } = session.services;
  if (worker === null) return [];
  const kinds = controller === 'ruida' ? ['ruida'] : controller === 'k40' ? [] : ['serial', 'tcp'];
  return found.value
    .filter(({ kind }) => kinds.includes(kind))
    .map(({ id, name }) => ({
      id,
      name: `${name}, through the worker`,
      open: (): Promise<MachineLink> => openBridge(worker, id, session.driverOptions()),
    }));
}
