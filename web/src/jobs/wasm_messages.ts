// SPDX-License-Identifier: GPL-3.0-or-later
// What the page and the Web Worker around the WASM module say to each other.
import type { Catalog, ErrorMessage, Job, OutputDescription, Progress, Report } from './contract';

export type ToWorker =
  | { readonly type: 'load'; readonly url: string; readonly cancelFlag: SharedArrayBuffer | null }
  | { readonly type: 'blob'; readonly sha256: string; readonly bytes: Uint8Array<ArrayBuffer> }
  | { readonly type: 'drop'; readonly sha256: string }
  | { readonly type: 'run'; readonly id: number; readonly job: Job };

export interface EncodedOutput extends OutputDescription {
  readonly data: Uint8Array<ArrayBuffer>;
}

export type FromWorker =
  | { readonly type: 'ready'; readonly catalog: Catalog }
  | { readonly type: 'progress'; readonly id: number; readonly progress: Progress }
  | {
      readonly type: 'done';
      readonly id: number;
      readonly report: Report;
      readonly outputs: Readonly<Record<string, EncodedOutput>>;
      readonly memory_mb: number;
    }
  | { readonly type: 'failed'; readonly id: number | null; readonly error: ErrorMessage };

/** The module's exports, as in docs/job_contract.md. */
export interface FormwrightModule {
  readonly HEAPU8: Uint8Array;
  lengthBytesUTF8(text: string): number;
  stringToUTF8(text: string, pointer: number, room: number): void;
  UTF8ToString(pointer: number): string;
  _malloc(bytes: number): number;
  _free(pointer: number): void;
  _fw_catalog(): number;
  _fw_blob_new(sha256: number, bytes: number): number;
  _fw_blob_has(sha256: number): number;
  _fw_blob_drop(sha256: number): void;
  _fw_run(job: number): number;
  _fw_output_data(name: number): number;
  _fw_output_size(name: number): number;
  _fw_memory_mb(): number;
}

export interface ModuleOptions {
  onProgress(fraction: number, stage: string, secondsLeft: number): void;
  cancelRequested(): boolean;
}

export type ModuleFactory = (options: ModuleOptions) => Promise<FormwrightModule>;
