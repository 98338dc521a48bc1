// SPDX-License-Identifier: GPL-3.0-or-later
// Which module runs which operation, against workers that answer at once.
import { describe, expect, it } from 'vitest';
import type { Catalog, Job, Operation } from './contract';
import type { WorkerLike } from './wasm_backend';
import type { FromWorker, ToWorker } from './wasm_messages';
import { WasmModules } from './wasm_modules';

const operation = (name: string, module: string): Operation => ({
  name,
  title: name,
  module,
  inputs: [],
  parameters: { properties: {} },
  outputs: [],
});
const catalog: Catalog = {
  version: 't',
  operations: [operation('relief', 'formwright'), operation('measure', 'formwright_pictures')],
  samples: [],
  mesh_formats: [],
};
const job = (name: string): Job => ({ operation: name, parameters: {}, inputs: {} });

class AnsweringWorker implements WorkerLike {
  onmessage: ((event: MessageEvent<FromWorker>) => void) | null = null;
  onerror: ((event: ErrorEvent) => void) | null = null;
  url = '';
  ran = 0;
  ended = false;
  postMessage(message: ToWorker): void {
    if (message.type === 'load') this.url = message.url;
    if (message.type === 'load') this.say({ type: 'ready', catalog });
    if (message.type !== 'run') return;
    this.ran += 1;
    const report = { module: this.url };
    this.say({ type: 'done', id: message.id, report, outputs: {}, memory_mb: 1 });
  }
  terminate(): void {
    this.ended = true;
  }
  say(message: FromWorker): void {
    queueMicrotask(() => this.onmessage?.({ data: message } as MessageEvent<FromWorker>));
  }
}

function modules() {
  const workers: AnsweringWorker[] = [];
  const backend = new WasmModules({
    moduleUrl: (module) => `${module}.mjs`,
    blobs: { read: () => Promise.reject(new Error('No inputs.')) },
    createWorker: () => {
      const worker = new AnsweringWorker();
      workers.push(worker);
      return worker;
    },
  });
  return { backend, workers };
}

describe('WasmModules', () => {
  it('loads the first module alone until a job needs another', async () => {
    const { backend, workers } = modules();
    await backend.run(job('relief'));
    expect(workers.map(({ url }) => url)).toEqual(['formwright.mjs']);
    const { report } = await backend.run(job('measure'));
    expect(report).toEqual({ module: 'formwright_pictures.mjs' });
    expect(workers).toHaveLength(2);
  });

  it('keeps the other module for its next job and ends it for one of the first', async () => {
    const { backend, workers } = modules();
    await backend.run(job('measure'));
    await backend.run(job('measure'));
    expect(workers.map(({ ran }) => ran)).toEqual([0, 2]);
    await backend.run(job('relief'));
    expect(workers.map(({ ended }) => ended)).toEqual([false, true]);
    await backend.run(job('measure'));
    expect(workers).toHaveLength(3);
  });

  it('runs jobs of different modules one after the other', async () => {
    const { backend, workers } = modules();
    const order: string[] = [];
    const both = ['measure', 'relief'].map((name) =>
      backend.run(job(name)).then(({ report }) => order.push(String(report['module']))),
    );
    await Promise.all(both);
    expect(order).toEqual(['formwright_pictures.mjs', 'formwright.mjs']);
    expect(workers[1]?.ended).toBe(true);
  });

  it('ends every module when it is disposed of', async () => {
    const { backend, workers } = modules();
    await backend.run(job('measure'));
    backend.dispose();
    expect(workers.every(({ ended }) => ended)).toBe(true);
  });
});
