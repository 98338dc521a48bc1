// SPDX-License-Identifier: GPL-3.0-or-later
// What machines were given to do, and how it ended. Written before the first line leaves, so that a crash leaves its trace.
import { signal } from '@preact/signals';

export interface LoggedJob {
  readonly id: string;
  readonly name: string;
  readonly machine: string;
  /** The machine was on the screen only. */
  readonly practice?: boolean;
  readonly started_unix_s: number;
  /** In the machine's time: of a practice job that was sped up, as long as a real machine takes. */
  readonly seconds: number | null;
  /** Null: the page was closed or crashed meanwhile. */
  readonly ended: string | null;
  readonly lines: number;
  readonly lines_done: number;
}

const key = 'formwright.machine_log';
const kept = 200;

export class JobLog {
  readonly #storage: Pick<Storage, 'getItem' | 'setItem'>;
  readonly jobs = signal<readonly LoggedJob[]>([]);

  constructor(storage: Pick<Storage, 'getItem' | 'setItem'>) {
    this.#storage = storage;
    this.jobs.value = this.#stored() ?? [];
  }

  /** Null where there is no log that can be read: a damaged one begins anew. */
  #stored(): readonly LoggedJob[] | null {
    try {
      const stored: unknown = JSON.parse(this.#storage.getItem(key) ?? 'null');
      return Array.isArray(stored) ? (stored as LoggedJob[]) : null;
    } catch {
      return null;
    }
  }

  /** Adds the job, or changes the one with its id; newest first. */
  put(job: LoggedJob): void {
    const before = this.#stored() ?? this.jobs.peek(); // other tabs write, too
    this.jobs.value = [job, ...before.filter(({ id }) => id !== job.id)].slice(0, kept);
    try {
      this.#storage.setItem(key, JSON.stringify(this.jobs.value));
    } catch {
      // No room: the log lasts as long as the page.
    }
  }
}
