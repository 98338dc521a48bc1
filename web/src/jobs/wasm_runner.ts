// SPDX-License-Identifier: GPL-3.0-or-later
// Drives the WASM module inside its Web Worker; apart from `wasm_worker.ts` so that it can be tested
// with a module that is not WASM.
import type { Catalog, ErrorCode, ErrorMessage, ResultMessage } from './contract';
import type { EncodedOutput, FormwrightModule, FromWorker, ModuleFactory, ToWorker } from './wasm_messages';

/** Progress is passed on at most this often; a solver may report far more. */
const progressInterval_ms = 50;

/** A trap, or an allocation that failed, leaves the module in no state to go on. */
function trapMessage(thrown: unknown): ErrorMessage {
  const text = thrown instanceof Error ? thrown.message : String(thrown);
  const memory = /memory|alloc|OOM/i.test(text);
  const code: ErrorCode = memory ? 'out_of_memory' : 'internal';
  const message = memory
    ? 'The browser ran out of memory; reduce the model, or solve in the worker program on your computer.'
    : `The solver stopped unexpectedly (${text}).`;
  return { code, where: '', message };
}

/** Above 2 GB an address comes out of WASM as a negative number. */
const address = (pointer: number): number => pointer >>> 0;

export class WasmRunner {
  #module: FormwrightModule | null = null;
  #cancelFlag: Int32Array | null = null;
  #jobId: number | null = null;
  #lastProgress = 0;
  readonly #post: (message: FromWorker, transfer: Transferable[]) => void;
  readonly #importFactory: (url: string) => Promise<ModuleFactory>;

  constructor(
    post: (message: FromWorker, transfer: Transferable[]) => void,
    importFactory: (url: string) => Promise<ModuleFactory>,
  ) {
    this.#post = post;
    this.#importFactory = importFactory;
  }

  async handle(message: ToWorker): Promise<void> {
    try {
      if (message.type === 'load') await this.#load(message.url, message.cancelFlag);
      else if (message.type === 'blob') this.#putBlob(message.sha256, message.bytes);
      else if (message.type === 'drop')
        this.#withString(message.sha256, (name) => this.#loaded()._fw_blob_drop(name));
      else this.#run(message.id, JSON.stringify(message.job));
    } catch (thrown) {
      this.#post(
        { type: 'failed', id: message.type === 'run' ? message.id : null, error: trapMessage(thrown) },
        [],
      );
    }
  }

  async #load(url: string, cancelFlag: SharedArrayBuffer | null): Promise<void> {
    this.#cancelFlag = cancelFlag === null ? null : new Int32Array(cancelFlag);
    const factory = await this.#importFactory(url);
    this.#module = await factory({
      onProgress: (fraction, stage, secondsLeft) => this.#progress(fraction, stage, secondsLeft),
      cancelRequested: () => this.#cancelFlag !== null && Atomics.load(this.#cancelFlag, 0) !== 0,
    });
    const catalog = JSON.parse(this.#module.UTF8ToString(address(this.#module._fw_catalog()))) as Catalog;
    this.#post({ type: 'ready', catalog }, []);
  }

  #loaded(): FormwrightModule {
    if (this.#module === null) throw new Error('The module is not loaded.');
    return this.#module;
  }

  #withString<T>(text: string, use: (pointer: number) => T): T {
    const module = this.#loaded();
    const room = module.lengthBytesUTF8(text) + 1;
    const pointer = address(module._malloc(room));
    module.stringToUTF8(text, pointer, room);
    try {
      return use(pointer);
    } finally {
      module._free(pointer);
    }
  }

  #putBlob(sha256: string, bytes: Uint8Array): void {
    const module = this.#loaded();
    const target = address(this.#withString(sha256, (name) => module._fw_blob_new(name, bytes.byteLength)));
    if (target === 0 && bytes.byteLength > 0) throw new Error('Out of memory for an input.');
    module.HEAPU8.set(bytes, target); // HEAPU8 read anew: the heap may just have grown
  }

  #run(id: number, job: string): void {
    const module = this.#loaded();
    this.#jobId = id;
    this.#lastProgress = 0;
    const text = this.#withString(job, (pointer) => module.UTF8ToString(address(module._fw_run(pointer))));
    this.#jobId = null;
    const result = JSON.parse(text) as ResultMessage;
    if ('error' in result) {
      this.#post({ type: 'failed', id, error: result.error }, []);
      return;
    }
    const outputs: Record<string, EncodedOutput> = {};
    for (const [name, description] of Object.entries(result.outputs)) {
      const data = this.#withString(name, (pointer) => {
        const size = address(module._fw_output_size(pointer));
        const start = address(module._fw_output_data(pointer));
        return module.HEAPU8.slice(start, start + size) as Uint8Array<ArrayBuffer>;
      });
      outputs[name] = { ...description, data };
    }
    const transfer = Object.values(outputs).map((output) => output.data.buffer);
    this.#post(
      { type: 'done', id, report: result.report, outputs, memory_mb: module._fw_memory_mb() },
      transfer,
    );
  }

  #progress(fraction: number, stage: string, secondsLeft: number): void {
    const now = performance.now();
    if (this.#jobId === null || now - this.#lastProgress < progressInterval_ms) return;
    this.#lastProgress = now;
    const seconds_left = secondsLeft < 0 ? null : secondsLeft;
    this.#post({ type: 'progress', id: this.#jobId, progress: { fraction, stage, seconds_left } }, []);
  }
}
