// SPDX-License-Identifier: GPL-3.0-or-later
// A solid on its way to a 3D printer: sliced by the PrusaSlicer of this computer, then kept as G-code or handed to a print server.
// What is under way goes on when the dialog is closed.
import { computed, signal } from '@preact/signals';
import { asJobError } from '../../jobs/contract';
import type { BridgeMachine } from '../../machines/links/bridge_link';
import { listBridgeMachines } from '../../machines/links/bridge_link';
import type { PrintFacts } from '../../machines/printing/gcode_facts';
import { printFacts } from '../../machines/printing/gcode_facts';
import type { WorkerTask } from '../../machines/printing/worker_tasks';
import { readBlob, readMachine, runTask, uploadGcode } from '../../machines/printing/worker_tasks';
import { toast } from '../../ui';
import { safeFileName } from '../session/download';
import type { Solid } from './print_request';
import type { Services } from '../session/services';

interface Sliced {
  readonly profile: string;
  readonly gcode: Uint8Array<ArrayBuffer>;
  readonly facts: PrintFacts;
}

export interface PrintServer {
  readonly name: string;
  readonly state: string;
  readonly software?: string;
}

/** The one that slices or sends now, where one does. */
const underWay = new Set<SliceSession>();

export class SliceSession {
  readonly services: Services;
  readonly solid: Solid;
  readonly looking = signal(true);
  readonly slicer = signal<BridgeMachine | null>(null);
  readonly profiles = signal<readonly string[]>([]);
  readonly profile = signal('');
  readonly servers = signal<readonly BridgeMachine[]>([]);
  readonly server = signal('');
  readonly serverNow = signal<PrintServer | null>(null);
  readonly sliced = signal<Sliced | null>(null);
  readonly task = signal<WorkerTask | null>(null);
  readonly problem = signal<string | null>(null);
  readonly done = signal<string | null>(null);
  #abort: AbortController | null = null;
  #open = true;

  /** Sliced with the profile in force. */
  readonly current = computed(() => {
    const sliced = this.sliced.value;
    return sliced?.profile === this.profile.value ? sliced : null;
  });

  constructor(services: Services, solid: Solid) {
    this.services = services;
    this.solid = solid;
    void this.#look();
  }

  /** For a dialog that opens: what is under way is shown again, so that it can be cancelled, whatever the new solid. */
  static of(services: Services, solid: Solid): SliceSession {
    const [running] = underWay;
    if (running === undefined) return new SliceSession(services, solid);
    running.#open = true;
    return running;
  }

  get fileName(): string {
    return `${safeFileName(this.solid.title.replace(/^the /, ''))}.gcode`;
  }

  async slice(): Promise<void> {
    const slicer = this.slicer.value;
    if (slicer === null) return;
    const profile = this.profile.value;
    await this.#run('Slicing', async (worker, options) => {
      const wishes = { wait: false, ...(profile ? { profile } : {}) };
      const { sha256 } = await runTask(worker, slicer.id, 'slice', this.solid.bytes, wishes, options);
      const gcode = await readBlob(worker, String(sha256));
      this.sliced.value = { profile, gcode, facts: printFacts(gcode) };
    });
  }

  /** `start` only after the person has confirmed it. */
  async upload(start: boolean): Promise<void> {
    const sliced = this.current.value;
    const server = this.servers.value.find(({ id }) => id === this.server.value);
    if (sliced === null || server === undefined) return;
    await this.#run(`Sending to ${server.name}`, async (worker, options) => {
      const kept = await uploadGcode(worker, server.id, sliced.gcode, this.fileName, start, options);
      this.done.value = start
        ? `${server.name} is printing ${kept}.`
        : `${kept} is at ${server.name}: start it there.`;
      await this.chooseServer(server.id);
    });
  }

  async chooseServer(id: string): Promise<void> {
    const { worker } = this.services;
    this.server.value = id;
    this.serverNow.value = null;
    if (worker === null || id === '') return;
    try {
      const now = await readMachine<PrintServer>(worker, id);
      if (this.server.value === id) this.serverNow.value = now;
    } catch (thrown) {
      if (this.server.value === id) this.problem.value = asJobError(thrown).message;
    }
  }

  cancel(): void {
    this.#abort?.abort();
  }

  /** The dialog is gone: what is under way goes on, and its end is told in a toast. */
  close(): void {
    this.#open = false;
  }

  async #run(
    words: string,
    run: (
      worker: NonNullable<Services['worker']>,
      options: { signal: AbortSignal; onTask: (task: WorkerTask) => void },
    ) => Promise<void>,
  ): Promise<void> {
    const { worker } = this.services;
    if (worker === null || this.task.value !== null) return;
    underWay.add(this);
    const abort = (this.#abort = new AbortController());
    this.problem.value = this.done.value = null;
    this.task.value = { id: '', state: 'sending', sentence: `${words}.`, fraction: 0 };
    try {
      await run(worker, { signal: abort.signal, onTask: (task) => (this.task.value = task) });
      if (!this.#open && this.done.value) toast(this.done.value);
    } catch (thrown) {
      const error = asJobError(thrown);
      // A request that is broken off says so in the browser's own words.
      if (error.code !== 'cancelled' && !abort.signal.aborted) {
        this.problem.value = error.message;
        if (!this.#open) toast(`${words}: ${error.message}`, true);
      }
    } finally {
      this.task.value = null;
      underWay.delete(this);
    }
  }

  async #look(): Promise<void> {
    const { worker, connection } = this.services;
    try {
      if (worker === null || connection.value?.state !== 'ready') return;
      const machines = await listBridgeMachines(worker);
      this.slicer.value = machines.find(({ kind }) => kind === 'slicer') ?? null;
      this.servers.value = machines.filter(({ kind }) => kind === 'octoprint' || kind === 'moonraker');
      if (this.slicer.value)
        this.profiles.value =
          (await readMachine<{ profiles?: string[] }>(worker, this.slicer.value.id)).profiles ?? [];
      this.profile.value = this.profiles.value[0] ?? '';
      const [first] = this.servers.value;
      if (first) await this.chooseServer(first.id);
    } catch (thrown) {
      this.problem.value = asJobError(thrown).message;
    } finally {
      this.looking.value = false;
    }
  }
}
