// SPDX-License-Identifier: GPL-3.0-or-later
// What the page holds of a machine, wherever that is connected.
import type { ReadonlySignal, Signal } from '@preact/signals';
import { signal } from '@preact/signals';
import type { EndChoice, FromMachineWorker, ToMachineWorker } from './machine_messages';
import { MachineRefusal } from './machine_module';
import type { MachineCommand, MachineEvent, MachineState } from './machine_state';

const keptEvents = 2000;
/** For a worker to close its line: longer than a transfer is waited for, so that a stop behind one still leaves. */
const patience_ms = 6000;
/** Workers that may still hold a port or a device. */
const leaving = new Set<Promise<void>>();

export interface MachineLink {
  /** Null until the driver has spoken. */
  readonly state: ReadonlySignal<MachineState | null>;
  /** What was sent and received, oldest first, the last two thousand. */
  readonly events: ReadonlySignal<readonly MachineEvent[]>;
  /** Why the line is gone, in a sentence; null while it is there, '' when it was closed from here. */
  readonly gone: ReadonlySignal<string | null>;
  /** Rejects with a MachineRefusal where the driver will not. */
  command(command: MachineCommand): Promise<void>;
  load(name: string, job: Uint8Array): Promise<void>;
  close(): Promise<void>;
  /** Only of a machine that exists on the screen: its time may run faster. */
  readonly practice?: PracticeSpeed;
}

export interface PracticeSpeed {
  /** Seconds of the machine a second of the wall, as measured. */
  readonly pace: ReadonlySignal<number>;
  /** While a job runs: 1 as a real machine, `fastest` as fast as the page can. */
  setSpeed(speed: number): Promise<void>;
}

/** Signals of a link, and how they are told. */
export class LinkSignals {
  readonly state: Signal<MachineState | null> = signal(null);
  readonly events: Signal<readonly MachineEvent[]> = signal([]);
  readonly gone: Signal<string | null> = signal(null);
  readonly pace: Signal<number> = signal(1);

  tell(state: MachineState, events: readonly MachineEvent[]): void {
    if (events.length > 0) this.events.value = [...this.events.value, ...events].slice(-keptEvents);
    this.state.value = state;
  }
}

type Waiting = { resolve(): void; reject(error: Error): void };
type WithoutId<T> = T extends { id: number } ? Omit<T, 'id'> : never;

/** A machine whose driver runs in a Web Worker of this page. */
export class WorkerLink implements MachineLink {
  readonly #signals = new LinkSignals();
  readonly state = this.#signals.state;
  readonly events = this.#signals.events;
  readonly gone = this.#signals.gone;
  readonly #worker: Worker;
  readonly #waiting = new Map<number, Waiting>();
  #nextId = 1;
  #opened = false;
  #left: Promise<void> | null = null;
  readonly practice?: PracticeSpeed;

  private constructor(worker: Worker, { kind }: EndChoice) {
    this.#worker = worker;
    const { pace } = this.#signals;
    if (kind === 'virtual')
      this.practice = { pace, setSpeed: (speed) => this.#ask({ type: 'speed', speed }) };
    worker.addEventListener('message', ({ data }: MessageEvent<FromMachineWorker>) => this.#hear(data));
    worker.addEventListener('error', () =>
      this.#end('The driver stopped unexpectedly. If the machine moves, switch it off.'),
    );
  }

  static async open(end: EndChoice, options: Readonly<Record<string, unknown>>): Promise<WorkerLink> {
    await Promise.all(leaving); // one of them may hold this very device
    const worker = new Worker(new URL('./machine_worker.ts', import.meta.url), {
      type: 'module',
      name: 'machine',
    });
    const link = new WorkerLink(worker, end);
    const module = new URL('wasm/machines.mjs', document.baseURI).href;
    try {
      await link.#ask({ type: 'open', module, options, end });
      link.#opened = true;
    } catch (thrown) {
      link.#end('');
      throw thrown;
    }
    return link;
  }

  command = (command: MachineCommand): Promise<void> => this.#ask({ type: 'command', command });
  load = (name: string, job: Uint8Array): Promise<void> => this.#ask({ type: 'load', name, job });
  /** Lets the virtual machine run into a limit switch, to practise that too. */
  trip = (): Promise<void> => this.#ask({ type: 'trip' });

  async close(): Promise<void> {
    await this.#leave();
    this.#end('');
  }

  #ask(message: WithoutId<ToMachineWorker>): Promise<void> {
    const id = this.#nextId++;
    return new Promise((resolve, reject) => {
      if (this.gone.value !== null) return reject(new Error('The machine is not connected.'));
      this.#waiting.set(id, { resolve, reject });
      this.#worker.postMessage({ ...message, id });
    });
  }

  #hear(message: FromMachineWorker): void {
    if (message.type === 'state') {
      if (message.pace !== undefined) this.#signals.pace.value = message.pace;
      return this.#signals.tell(message.state, message.events);
    }
    if (message.type === 'gone') return this.#end(message.why ?? '');
    const waiting = this.#waiting.get(message.id);
    this.#waiting.delete(message.id);
    const { error } = message;
    if (error === null) waiting?.resolve();
    else waiting?.reject(new MachineRefusal(error.code, error.where, error.message));
  }

  #end(why: string): void {
    if (this.gone.value !== null) return;
    this.gone.value = why;
    for (const { reject } of this.#waiting.values())
      reject(new Error(why === '' ? 'The machine was disconnected.' : why));
    this.#waiting.clear();
    void this.#leave();
  }

  /** Ends the worker, however the line came to its end: while it lives, port and device stay with it. */
  #leave(): Promise<void> {
    if (this.#left !== null) return this.#left;
    const left = this.#lineClosed().then(() => {
      this.#worker.terminate();
      leaving.delete(left);
    });
    leaving.add(left);
    return (this.#left = left);
  }

  /** Resolves once the worker has written what waited and closed its line, or when that takes too long. */
  #lineClosed(): Promise<void> {
    if (!this.#opened) return Promise.resolve();
    const id = this.#nextId++;
    return new Promise((resolve) => {
      this.#worker.addEventListener('message', ({ data }: MessageEvent<FromMachineWorker>) => {
        if (data.type === 'done' && data.id === id) resolve();
      });
      this.#worker.postMessage({ type: 'close', id } satisfies ToMachineWorker);
      setTimeout(resolve, patience_ms);
    });
  }
}
