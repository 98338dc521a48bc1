// SPDX-License-Identifier: GPL-3.0-or-later
// The worker's side of the WASM backend with a module that is plain TypeScript over one array.
import { expect, it } from 'vitest';
import type { FormwrightModule, FromWorker, ModuleOptions } from './wasm_messages';
import { WasmRunner } from './wasm_runner';

function fakeModule(run: (job: string, options: ModuleOptions) => string) {
  const heap = new Uint8Array(4096);
  const texts = new Map<number, string>();
  const blobs = new Map<string, { start: number; size: number }>();
  let top = 8;
  const take = (size: number) => {
    const start = top;
    top += size;
    return start;
  };
  const text = (value: string) => {
    const pointer = take(1);
    texts.set(pointer, value);
    return pointer;
  };
  const string = (pointer: number) => texts.get(pointer) ?? '';
  const factory = (options: ModuleOptions): Promise<FormwrightModule> =>
    Promise.resolve({
      HEAPU8: heap,
      lengthBytesUTF8: (value) => value.length,
      stringToUTF8: (value, pointer) => void texts.set(pointer, value),
      _malloc: take,
      UTF8ToString: string,
      _free: (pointer) => void texts.delete(pointer),
      _fw_catalog: () => text('{"version":"1","operations":[],"samples":[],"mesh_formats":[]}'),
      _fw_blob_new: (name, size) => {
        const start = take(size);
        blobs.set(string(name), { start, size });
        return start;
      },
      _fw_blob_has: (name) => (blobs.has(string(name)) ? 1 : 0),
      _fw_blob_drop: (name) => void blobs.delete(string(name)),
      _fw_run: (job) => text(run(string(job), options)),
      _fw_output_data: () => 8,
      _fw_output_size: () => 3,
      _fw_memory_mb: () => 12,
    });
  return { factory, heap, blobs };
}

const job = { operation: 'relief', parameters: {}, inputs: {} };

async function started(run: Parameters<typeof fakeModule>[0], flag: SharedArrayBuffer | null = null) {
  const module = fakeModule(run);
  const said: FromWorker[] = [];
  const runner = new WasmRunner(
    (message) => said.push(message),
    () => Promise.resolve(module.factory),
  );
  await runner.handle({ type: 'load', url: 'x', cancelFlag: flag });
  return { runner, said, ...module };
}

it('loads, takes a blob, runs, and copies outputs out of the heap', async () => {
  const { runner, said, heap, blobs } = await started(() =>
    JSON.stringify({ report: { vertices: 2 }, outputs: { 'a.ply': { media_type: 'm', bytes: 3 } } }),
  );
  await runner.handle({ type: 'blob', sha256: 'f00', bytes: new Uint8Array([5, 6, 7]) });
  const { start } = blobs.get('f00') ?? expect.fail('no blob');
  expect([...heap.subarray(start, start + 3)]).toEqual([5, 6, 7]);
  await runner.handle({ type: 'run', id: 4, job });
  expect(said.map(({ type }) => type)).toEqual(['ready', 'done']);
  const done = said[1];
  if (done?.type !== 'done') expect.fail('not done');
  expect(done).toMatchObject({ id: 4, report: { vertices: 2 }, memory_mb: 12 });
  heap.fill(0);
  expect(done.outputs['a.ply']?.data.byteLength).toBe(3);
  await runner.handle({ type: 'drop', sha256: 'f00' });
  expect(blobs.size).toBe(0);
});

it('passes progress with the job’s id and reads the cancel flag', async () => {
  const flag = new SharedArrayBuffer(4);
  const seen: boolean[] = [];
  const { runner, said } = await started((_, options) => {
    options.onProgress(0.25, 'Factorising', -1);
    options.onProgress(0.26, 'Factorising', -1); // too soon after the first: left out
    seen.push(options.cancelRequested());
    Atomics.store(new Int32Array(flag), 0, 1);
    seen.push(options.cancelRequested());
    return JSON.stringify({ error: { code: 'cancelled', where: '', message: 'Cancelled.' } });
  }, flag);
  await runner.handle({ type: 'run', id: 9, job });
  expect(seen).toEqual([false, true]);
  const progress = said.filter(({ type }) => type === 'progress');
  expect(progress).toEqual([
    { type: 'progress', id: 9, progress: { fraction: 0.25, stage: 'Factorising', seconds_left: null } },
  ]);
  expect(said.at(-1)).toMatchObject({ type: 'failed', id: 9, error: { code: 'cancelled' } });
});

it('tells a trap from a lack of memory', async () => {
  const trap = await started(() => {
    throw new Error('unreachable');
  });
  await trap.runner.handle({ type: 'run', id: 1, job });
  expect(trap.said.at(-1)).toMatchObject({ type: 'failed', id: 1, error: { code: 'internal' } });
  const memory = await started(() => {
    throw new RangeError('Array buffer allocation failed');
  });
  await memory.runner.handle({ type: 'run', id: 1, job });
  expect(memory.said.at(-1)).toMatchObject({ error: { code: 'out_of_memory' } });
});
