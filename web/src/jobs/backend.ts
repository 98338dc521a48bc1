// SPDX-License-Identifier: GPL-3.0-or-later
// What runs jobs: the core in this browser, or the native worker on this machine.
import type { Catalog, Job, Progress, Report } from './contract';

export interface Output {
  readonly name: string;
  readonly mediaType: string;
  readonly bytes: number;
  read(): Promise<Uint8Array<ArrayBuffer>>;
}

export interface Result {
  readonly report: Report;
  readonly outputs: ReadonlyMap<string, Output>;
}

/** Why a signal was aborted: nobody waits here any more, but a job that outlives the page is to go on, for `resume` to find. */
export const leaving = Symbol('leaving');

export interface RunOptions {
  /** Ends the job, except where it is aborted for `leaving` and the job has a lasting name. */
  readonly signal?: AbortSignal;
  readonly onProgress?: (progress: Progress) => void;
  /** Told as soon as the backend has a lasting name for the job, under which `resume` finds it again. */
  readonly onAccepted?: (id: string) => void;
}

/** Where a backend gets the bytes of an input it does not know yet. */
export interface BlobSource {
  read(sha256: string): Promise<Uint8Array<ArrayBuffer>>;
}

export interface Backend {
  readonly kind: 'wasm' | 'native' | 'mock';
  catalog(): Promise<Catalog>;
  /** Runs one job to its end; blobs that are missing are fetched from the source. Throws JobError. */
  run(job: Job, options?: RunOptions): Promise<Result>;
  /** Waits for a job accepted earlier; only where jobs outlive the page. */
  resume?(id: string, options?: RunOptions): Promise<Result>;
  dispose(): void;
}
