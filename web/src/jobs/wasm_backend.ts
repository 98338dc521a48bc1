// SPDX-License-Identifier: GPL-3.0-or-later
// The core in this browser: one Web Worker, one job at a time. The worker is thrown away after a trap or
// when memory ran out, and where cancelling needs it; the next job starts a new one and sends the blobs
// it needs again.
import type { Backend, BlobSource, Output, Result, RunOptions } from './backend';
import type { Catalog, ErrorMessage, Job } from './contract';
import { cancelled, JobError } from './contract';
import type { FromWorker, ToWorker } from './wasm_messages';

export interface WorkerLike {
  postMessage(message: ToWorker, transfer?: Transferable[]): void;
  terminate(): void;
  onmessage: ((event: MessageEvent<FromWorker>) => void) | null;
  onerror: ((event: ErrorEvent) => void) | null;
}

export interface WasmBackendOptions {
  readonly moduleUrl: string;
  readonly blobs: BlobSource;
  readonly createWorker?: () => WorkerLike;
  /** Defaults to whether the page is cross-origin isolated. */
  readonly canShareMemory?: boolean;
}

/** How long a solver may take to notice the flag before its worker is ended. */
const cancelGrace_ms = 1500;

/** Inputs left in the module's heap for the next jobs: source, model and preview of two projects. */
const keptBlobs = 6;

interface Instance {
  readonly worker: WorkerLike;
  readonly ready: Promise<Catalog>;
  readonly knownBlobs: Set<string>;
  readonly cancelFlag: Int32Array | null;
  fail(error: JobError): void;
  ended: JobError | null;
}

interface Running {
  readonly id: number;
  readonly options: RunOptions;
  resolve(result: Result): void;
  reject(error: JobError): void;
}

export class WasmBackend implements Backend {
  readonly kind = 'wasm';
  /** Heap in use after the last job. */
  memory_mb = 0;
  readonly #options: WasmBackendOptions;
  #instance: Instance | null = null;
  #running: Running | null = null;
  #nextId = 1;
  #tail: Promise<unknown> = Promise.resolve();
  #catalog: Catalog | null = null;

  constructor(options: WasmBackendOptions) {
    this.#options = options;
  }

  async catalog(): Promise<Catalog> {
    this.#catalog ??= await this.#start().ready;
    return this.#catalog;
  }

  run(job: Job, options: RunOptions = {}): Promise<Result> {
    const result = this.#tail.then(() => this.#runNow(job, options));
    this.#tail = result.catch(() => undefined);
    return result;
  }

  dispose(): void {
    this.#discard(cancelled());
  }

  async #runNow(job: Job, options: RunOptions): Promise<Result> {
    const { signal } = options;
    if (signal?.aborted) throw cancelled();
    const instance = this.#start();
    await instance.ready;
    for (const input of Object.values(job.inputs)) {
      if (!('sha256' in input) || instance.knownBlobs.has(input.sha256)) continue;
      const bytes = await this.#options.blobs.read(input.sha256);
      // Ended meanwhile: `ready` has settled long ago, so what ended it is told here.
      if (this.#instance !== instance) throw instance.ended ?? cancelled();
      // Copied by the message, not transferred: the source may keep its bytes in memory.
      instance.worker.postMessage({ type: 'blob', sha256: input.sha256, bytes });
      instance.knownBlobs.add(input.sha256);
    }
    this.#dropOldBlobs(instance, job);
    if (signal?.aborted) throw cancelled();
    return await new Promise<Result>((resolve, reject) => {
      const id = this.#nextId++;
      let grace: ReturnType<typeof setTimeout> | undefined;
      const abort = () => {
        if (instance.cancelFlag === null) this.#discard(cancelled());
        else {
          Atomics.store(instance.cancelFlag, 0, 1);
          grace = setTimeout(() => this.#discard(cancelled()), cancelGrace_ms);
        }
      };
      const settle = () => {
        clearTimeout(grace);
        signal?.removeEventListener('abort', abort);
        this.#running = null;
      };
      this.#running = {
        id,
        options,
        resolve: (result) => {
          settle();
          resolve(result);
        },
        reject: (error) => {
          settle();
          reject(error);
        },
      };
      signal?.addEventListener('abort', abort);
      if (instance.cancelFlag !== null) Atomics.store(instance.cancelFlag, 0, 0);
      instance.worker.postMessage({ type: 'run', id, job });
    });
  }

  /** Keeps the heap from filling with models that were replaced long ago. */
  #dropOldBlobs(instance: Instance, job: Job): void {
    const used = new Set(Object.values(job.inputs).map((input) => ('sha256' in input ? input.sha256 : '')));
    for (const sha256 of instance.knownBlobs) {
      if (instance.knownBlobs.size <= keptBlobs) return;
      if (used.has(sha256)) continue;
      instance.worker.postMessage({ type: 'drop', sha256 });
      instance.knownBlobs.delete(sha256);
    }
  }

  #start(): Instance {
    if (this.#instance !== null) return this.#instance;
    const worker = this.#options.createWorker?.() ?? defaultWorker();
    const share = this.#options.canShareMemory ?? globalThis.crossOriginIsolated;
    const shared = share ? new SharedArrayBuffer(4) : null;
    let fail!: (error: JobError) => void;
    const ready = new Promise<Catalog>((resolve, reject) => {
      fail = reject;
      worker.onmessage = ({ data }) => {
        if (data.type === 'ready') resolve(data.catalog);
        else this.#receive(data);
      };
      worker.onerror = (event) =>
        this.#fatal({
          code: 'internal',
          where: '',
          message: event.message || 'The solver could not be loaded.',
        });
    });
    ready.catch(() => undefined);
    const cancelFlag = shared === null ? null : new Int32Array(shared);
    this.#instance = { worker, ready, knownBlobs: new Set(), cancelFlag, fail, ended: null };
    worker.postMessage({ type: 'load', url: this.#options.moduleUrl, cancelFlag: shared });
    return this.#instance;
  }

  #receive(message: Exclude<FromWorker, { type: 'ready' }>): void {
    if (message.type === 'failed' && message.id === null) {
      this.#fatal(message.error);
      return;
    }
    const running = this.#running;
    if (running === null || running.id !== message.id) return;
    if (message.type === 'progress') running.options.onProgress?.(message.progress);
    else if (message.type === 'failed') {
      const { code } = message.error;
      if (code === 'internal' || code === 'out_of_memory') this.#fatal(message.error);
      else running.reject(new JobError(message.error));
    } else {
      this.memory_mb = message.memory_mb;
      const outputs = new Map<string, Output>();
      for (const [name, output] of Object.entries(message.outputs)) {
        const read = () => Promise.resolve(output.data);
        outputs.set(name, { name, mediaType: output.media_type, bytes: output.data.byteLength, read });
      }
      running.resolve({ report: message.report, outputs });
    }
  }

  #fatal(error: ErrorMessage): void {
    this.#discard(new JobError(error));
  }

  /** Ends the worker; what runs, and what waits for it to load, fails with `error`. */
  #discard(error: JobError): void {
    const instance = this.#instance;
    this.#instance = null;
    if (instance !== null) instance.ended = error;
    instance?.worker.terminate();
    instance?.fail(error);
    this.#running?.reject(error);
  }
}

function defaultWorker(): WorkerLike {
  return new Worker(new URL('./wasm_worker.ts', import.meta.url), { type: 'module' }) as WorkerLike;
}
