// SPDX-License-Identifier: GPL-3.0-or-later
// A machine of the worker's: the driver runs there, the page steers it over a socket (docs/machine_bridge.md).
import { sha256Hex } from '../../jobs/hash';
import type { NativeConnection } from '../../jobs/native_connection';
import type { MachineLink } from './machine_link';
import { LinkSignals } from './machine_link';
import { MachineRefusal } from './machine_module';
import type { MachineCommand, MachineEvent, MachineState } from './machine_state';

export interface BridgeMachine {
  readonly id: string;
  readonly name: string;
  readonly kind: 'serial' | 'ruida' | 'tcp' | 'printer' | 'octoprint' | 'moonraker' | 'slicer';
  readonly detail: string;
  readonly state: string;
}

export const listBridgeMachines = (worker: NativeConnection): Promise<BridgeMachine[]> =>
  worker.json<BridgeMachine[]>('machines');

interface FromBridge {
  readonly state?: MachineState;
  readonly events?: readonly MachineEvent[];
  readonly error?: { readonly code: string; readonly where: string; readonly message: string };
  readonly done?: number;
  readonly n?: number;
  readonly closed?: boolean;
}

type Waiting = { resolve(): void; reject(error: Error): void };

class BridgeLink implements MachineLink {
  readonly #signals = new LinkSignals();
  readonly state = this.#signals.state;
  readonly events = this.#signals.events;
  readonly gone = this.#signals.gone;
  readonly #worker: NativeConnection;
  readonly #socket: WebSocket;
  readonly #waiting = new Map<number, Waiting>();
  #next = 1;
  #lastError = '';

  constructor(worker: NativeConnection, socket: WebSocket) {
    this.#worker = worker;
    this.#socket = socket;
    socket.onmessage = (event: MessageEvent<string>) => this.#hear(JSON.parse(event.data) as FromBridge);
    socket.onclose = () =>
      this.#end(this.#lastError || 'The connection to the worker was lost. The worker pauses the machine.');
  }

  command = (command: MachineCommand): Promise<void> => this.#ask({ command });

  async load(name: string, job: Uint8Array): Promise<void> {
    const bytes = new Uint8Array(job);
    const sha256 = await sha256Hex(bytes);
    await this.#worker.requestOk(`blobs/${sha256}`, { method: 'PUT', body: bytes });
    await this.#ask({ load: { name, sha256 } });
  }

  async close(): Promise<void> {
    await this.#ask({ close: true }).catch(() => undefined);
    this.#end('');
    this.#socket.close();
  }

  open = (options: Readonly<Record<string, unknown>>): Promise<void> => this.#ask({ open: options });

  #ask(message: object): Promise<void> {
    const n = this.#next++;
    return new Promise((resolve, reject) => {
      if (this.gone.value !== null || this.#socket.readyState !== WebSocket.OPEN)
        return reject(new Error('The machine is not connected.'));
      this.#waiting.set(n, { resolve, reject });
      this.#socket.send(JSON.stringify({ ...message, n }));
    });
  }

  #hear(message: FromBridge): void {
    const { state, events, error, done, n, closed } = message;
    if (state) this.#signals.tell(state, events ?? []);
    else if (events && this.state.value) this.#signals.tell(this.state.value, events);
    const number = done ?? n;
    const waiting = number === undefined ? undefined : this.#waiting.get(number);
    if (number !== undefined) this.#waiting.delete(number);
    if (error) {
      this.#lastError = error.message;
      waiting?.reject(new MachineRefusal(error.code, error.where, error.message));
    } else waiting?.resolve();
    if (closed) this.#end(error?.message ?? '');
  }

  #end(why: string): void {
    if (this.gone.value === null) this.gone.value = why;
    for (const { reject } of this.#waiting.values())
      reject(new Error(why || 'The machine was disconnected.'));
    this.#waiting.clear();
  }
}

export async function openBridge(
  worker: NativeConnection,
  machineId: string,
  options: Readonly<Record<string, unknown>>,
): Promise<MachineLink> {
  const socket = worker.socket(`machines/${encodeURIComponent(machineId)}/socket`, 'formwright.machine.v1');
  await new Promise<void>((resolve, reject) => {
    socket.onopen = () => resolve();
    socket.onclose = () =>
      reject(new Error('The worker could not open the machine: check that it is plugged in.'));
  });
  const link = new BridgeLink(worker, socket);
  try {
    await link.open(options);
  } catch (thrown) {
    socket.close();
    throw thrown;
  }
  return link;
}
