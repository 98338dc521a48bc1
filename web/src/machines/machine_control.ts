// SPDX-License-Identifier: GPL-3.0-or-later
// The machine that this page controls: at most one, in one tab at a time, whichever room is looked at.
import type { ReadonlySignal } from '@preact/signals';
import { computed, effect, signal } from '@preact/signals';
import type { JobLog } from './job_log';
import type { MachineLink } from './links/machine_link';
import type { MachineCommand, MachineJob, MachineState, ZChoice } from './links/machine_state';
import type { MachineProfile } from './profiles';

const lockName = 'formwright.machine';

interface Held {
  readonly release: () => void;
  /** Once others can have it. */
  readonly free: Promise<unknown>;
}

/** Held while a machine is controlled; null where another tab holds it. */
async function takeLock(): Promise<Held | null> {
  if (!('locks' in navigator)) return { release: () => undefined, free: Promise.resolve() };
  return await new Promise((resolve) => {
    const free: Promise<unknown> = navigator.locks.request(lockName, { ifAvailable: true }, (lock) => {
      if (lock === null) return resolve(null);
      return new Promise<void>((release) => queueMicrotask(() => resolve({ release, free })));
    });
  });
}

export class MachineControl {
  readonly #log: JobLog;
  /** How often z was set to 0 in this page. */
  readonly zSets = signal(0);
  readonly link = signal<MachineLink | null>(null);
  readonly connecting = signal(false);
  /** The machine that is connected exists on the screen only. */
  readonly practising = signal(false);
  /** Seconds of the machine a second, in which a practice machine works off jobs; real ones have their own time. */
  readonly practiceSpeed = signal(1);
  /** The same as it is now, as measured; 1 of a real machine. */
  readonly pace: ReadonlySignal<number> = computed(() => this.link.value?.practice?.pace.value ?? 1);
  /** What went wrong last, in a sentence. */
  readonly problem = signal<string | null>(null);
  readonly machineName = signal('');
  /** The job the driver holds: its name, and what it was made from. */
  readonly loaded = signal<string | null>(null);
  /** The job that was under way when its machine went, and what it was made from: the next driver knows nothing of it. */
  readonly cutOff = signal<{ readonly key: string; readonly job: MachineJob } | null>(null);
  readonly state: ReadonlySignal<MachineState | null> = computed(() => this.link.value?.state.value ?? null);
  #held: Held | null = null;
  #free: Promise<unknown> = Promise.resolve();
  #jobId = '';

  constructor(log: JobLog) {
    this.#log = log;
    effect(() => {
      const gone = this.link.value?.gone.value ?? null;
      if (gone !== null) this.#lost(gone);
    });
    effect(() => this.#writeLog());
    effect(() => {
      const speed = this.practiceSpeed.value;
      void this.link.value?.practice?.setSpeed(speed).catch(() => undefined); // gone meanwhile
    });
    addEventListener('beforeunload', (event) => {
      if (this.isBusy) event.preventDefault();
    });
    // The page goes: the machine must not go on without anyone, nor its laser shine.
    addEventListener('pagehide', () => {
      const order = this.isBusy
        ? 'pause'
        : (['focus_off', 'jog_cancel'] as const).find((what) => this.can(what));
      if (order) void this.link.value?.command({ do: order }).catch(() => undefined);
    });
  }

  get isBusy(): boolean {
    const job = this.state.value?.job;
    return job !== null && job !== undefined && job.ended === null;
  }

  can(what: MachineCommand['do']): boolean {
    return this.state.value?.can.includes(what) ?? false;
  }

  async connect(
    profile: MachineProfile,
    open: () => Promise<MachineLink | null>,
    practising = false,
  ): Promise<void> {
    if (this.link.value !== null || this.connecting.value) return;
    this.connecting.value = true;
    this.problem.value = null;
    try {
      await this.#free; // by this page itself, a moment ago
      this.#held = await takeLock();
      if (this.#held === null)
        throw new Error('Another tab of this page controls a machine: disconnect it there first.');
      const link = await open();
      this.machineName.value = profile.name;
      this.practising.value = practising;
      this.loaded.value = null;
      if (link === null) this.#unlock();
      else this.link.value = link;
    } catch (thrown) {
      this.#unlock();
      this.problem.value = thrown instanceof Error ? thrown.message : String(thrown);
    } finally {
      this.connecting.value = false;
    }
  }

  async disconnect(): Promise<void> {
    await this.link.value?.close();
  }

  /** Tells the machine; what it refuses becomes the problem. True where it was taken. */
  async command(command: MachineCommand): Promise<boolean> {
    const link = this.link.value;
    if (link === null) return false;
    this.problem.value = null;
    try {
      await link.command(command);
      if (command.do === 'set_origin' && command.axes?.includes('z')) ++this.zSets.value;
      return true;
    } catch (thrown) {
      this.problem.value = thrown instanceof Error ? thrown.message : String(thrown);
      return false;
    }
  }

  /** Gives the job to the machine unless it has it already. True where it was taken. */
  async load(name: string, key: string, job: Uint8Array): Promise<boolean> {
    const link = this.link.value;
    if (link === null) return false;
    if (this.loaded.value === key) return true;
    this.problem.value = null;
    try {
      await link.load(name, job);
      this.loaded.value = key;
      return true;
    } catch (thrown) {
      this.problem.value = thrown instanceof Error ? thrown.message : String(thrown);
      return false;
    }
  }

  /** Loads the job unless the machine has it already, and starts it. */
  async start(
    name: string,
    key: string,
    job: Uint8Array,
    { from_line, z }: { readonly from_line?: number; readonly z?: ZChoice } = {},
  ): Promise<boolean> {
    if (!(await this.load(name, key, job))) return false;
    this.#jobId = crypto.randomUUID();
    const started = await this.command({
      do: 'start',
      confirmed: true,
      ...(from_line === undefined ? {} : { from_line }),
      ...(z === undefined ? {} : { z }),
    });
    if (started && z === 'here') ++this.zSets.value;
    // Refused, the rest of the job before can still be cut.
    if (started) this.cutOff.value = null;
    return started;
  }

  #lost(why: string): void {
    this.#writeLog();
    const job = this.state.peek()?.job;
    const key = this.loaded.peek();
    if (job && key !== null && job.ended !== 'done' && job.careful_line !== undefined)
      this.cutOff.value = { key, job: { ...job, ended: job.ended ?? 'cut_off' } };
    this.link.value = null;
    this.loaded.value = null;
    if (why !== '')
      this.problem.value = `${why} Where the head stands is unknown until the machine is homed again.`;
    this.#unlock();
  }
  #unlock(): void {
    if (this.#held) this.#free = this.#held.free;
    this.#held?.release();
    this.#held = null;
  }

  #writeLog(): void {
    const job = this.state.value?.job;
    if (!job || this.#jobId === '') return;
    const known = this.#log.jobs.peek().find(({ id }) => id === this.#jobId);
    if (known && known.ended === job.ended && job.acknowledged - known.lines_done < 100 && job.ended === null)
      return;
    if (known && known.ended !== null) return;
    this.#log.put({
      id: this.#jobId,
      name: job.name,
      machine: this.machineName.peek(),
      ...(this.practising.peek() ? { practice: true } : {}),
      started_unix_s: known?.started_unix_s ?? Math.round(Date.now() / 1000),
      seconds: job.ended === null ? null : job.seconds,
      ended: job.ended,
      lines: job.line_count,
      lines_done: job.acknowledged,
    });
  }
}
