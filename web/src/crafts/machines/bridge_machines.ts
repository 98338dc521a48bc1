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
    if (worker && connection.value?.state === 'ready')
      found.value = await lookAt(worker).catch(() => found.value);
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

/** The list, with what print servers do now: that they are asked for one by one. */
async function lookAt(worker: NativeConnection): Promise<BridgeMachine[]> {
  const machines = await listBridgeMachines(worker);
  const now = async (machine: BridgeMachine): Promise<BridgeMachine> => {
    if (machine.kind !== 'octoprint' && machine.kind !== 'moonraker') return machine;
    const state = await readMachine<{ state: string }>(worker, machine.id).then(
      (server) => server.state,
      () => 'off',
    );
    return { ...machine, state };
  };
  return await Promise.all(machines.map(now));
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
