// SPDX-License-Identifier: GPL-3.0-or-later
// The core in this browser as one backend. It comes in modules (`module` of an operation in the catalog): the first
// lists all operations and runs most; another is loaded when a job first needs it.
import type { Backend, BlobSource, Result, RunOptions } from './backend';
import type { Catalog, Job } from './contract';
import { findOperation } from './contract';
import type { WorkerLike } from './wasm_backend';
import { WasmBackend } from './wasm_backend';

const firstModule = 'formwright';

interface WasmModulesOptions {
  readonly moduleUrl: (module: string) => string;
  readonly blobs: BlobSource;
  readonly createWorker?: () => WorkerLike;
}

export class WasmModules implements Backend {
  readonly kind = 'wasm';
  readonly #options: WasmModulesOptions;
  readonly #first: WasmBackend;
  #other: { readonly module: string; readonly backend: WasmBackend } | null = null;
  #tail: Promise<unknown> = Promise.resolve();

  constructor(options: WasmModulesOptions) {
    this.#options = options;
    this.#first = this.#load(firstModule);
  }

  catalog(): Promise<Catalog> {
    return this.#first.catalog();
  }

  run(job: Job, options: RunOptions = {}): Promise<Result> {
    const result = this.#tail.then(async () =>
      this.#backendOf(await this.catalog(), job.operation).run(job, options),
    );
    this.#tail = result.catch(() => undefined);
    return result;
  }

  dispose(): void {
    this.#first.dispose();
    this.#endOther();
  }

  /** Ends the module that is not needed, because pictures take hundreds of megabytes that no heap gives back. */
  #backendOf(catalog: Catalog, operation: string): WasmBackend {
    const module = findOperation(catalog, operation)?.module ?? firstModule;
    if (this.#other !== null && this.#other.module !== module) this.#endOther();
    if (module === firstModule) return this.#first;
    this.#other ??= { module, backend: this.#load(module) };
    return this.#other.backend;
  }

  #endOther(): void {
    this.#other?.backend.dispose();
    this.#other = null;
  }

  #load(module: string): WasmBackend {
    const { moduleUrl, ...rest } = this.#options;
    return new WasmBackend({ moduleUrl: moduleUrl(module), ...rest });
  }
}
