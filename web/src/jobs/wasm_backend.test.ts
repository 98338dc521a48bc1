// SPDX-License-Identifier: GPL-3.0-or-later
// The page's side of the WASM backend against a worker that only keeps what it is sent.
import { beforeEach, describe, expect, it, vi } from 'vitest';
import type { Catalog, Job } from './contract';
import { WasmBackend } from './wasm_backend';
import type { WorkerLike } from './wasm_backend';
import type { FromWorker, ToWorker } from './wasm_messages';

const catalog: Catalog = { version: 't', operations: [], samples: [], mesh_formats: [] };
const hash = (digit: string) => digit.repeat(64);
const job = (digit: string): Job => ({
  operation: 'relief',
  parameters: {},
  inputs: { mesh: { sha256: hash(digit), file_name: 'a.obj' } },
});

class FakeWorker implements WorkerLike {
  onmessage: ((event: MessageEvent<FromWorker>) => void) | null = null;
  onerror: ((event: ErrorEvent) => void) | null = null;
  readonly sent: ToWorker[] = [];
  ended = false;
  postMessage(message: ToWorker): void {
    this.sent.push(message);
    if (message.type === 'load') queueMicrotask(() => this.say({ type: 'ready', catalog }));
  }
  terminate(): void {
    this.ended = true;
  }
  say(message: FromWorker): void {
    this.onmessage?.({ data: message } as MessageEvent<FromWorker>);
  }
  runs() {
    return this.sent.filter((message) => message.type === 'run');
  }
  finish(): void {
    const id = this.runs().at(-1)?.id ?? 0;
    const data = new Uint8Array([1, 2]);
    const outputs = { 'relief.ply': { media_type: 'application/x-ply', bytes: 2, data } };
    this.say({ type: 'done', id, report: { vertices: 3 }, outputs, memory_mb: 7 });
  }
  fail(code: 'could_not_solve' | 'out_of_memory'): void {
    this.say({ type: 'failed', id: this.runs().at(-1)?.id ?? 0, error: { code, where: '', message: code } });
  }
}

let workers: FakeWorker[];
let read: ReturnType<typeof vi.fn<(sha256: string) => Promise<Uint8Array<ArrayBuffer>>>>;
const worker = () => workers.at(-1) ?? expect.fail('no worker');
const until = (condition: () => boolean) => vi.waitFor(() => expect(condition()).toBe(true), { interval: 1 });

function backend(canShareMemory = true): WasmBackend {
  const createWorker = () => {
    workers.push(new FakeWorker());
    return worker();
  };
  return new WasmBackend({ moduleUrl: 'm', blobs: { read }, createWorker, canShareMemory });
}

beforeEach(() => {
  workers = [];
  read = vi.fn(() => Promise.resolve(new Uint8Array([9])));
});

describe('WasmBackend', () => {
  it('sends a blob once and hands out outputs and report', async () => {
    const wasm = backend();
    for (let i = 0; i < 2; ++i) {
      const running = wasm.run(job('a'));
      await until(() => worker().runs().length === i + 1);
      worker().finish();
      const result = await running;
      expect(result.report).toEqual({ vertices: 3 });
      expect(await result.outputs.get('relief.ply')?.read()).toEqual(new Uint8Array([1, 2]));
    }
    expect(read).toHaveBeenCalledTimes(1);
    expect(wasm.memory_mb).toBe(7);
    expect(await wasm.catalog()).toBe(catalog);
  });

  it('runs one job at a time and passes progress to the right one', async () => {
    const wasm = backend();
    const seen: string[] = [];
    const first = wasm.run(job('a'), { onProgress: ({ stage }) => seen.push(`1 ${stage}`) });
    const second = wasm.run(job('a'), { onProgress: ({ stage }) => seen.push(`2 ${stage}`) });
    await until(() => worker().runs().length === 1);
    const [run] = worker().runs();
    worker().say({
      type: 'progress',
      id: run?.id ?? 0,
      progress: { fraction: 0.5, stage: 'x', seconds_left: null },
    });
    worker().finish();
    await first;
    await until(() => worker().runs().length === 2);
    worker().say({
      type: 'progress',
      id: run?.id ?? 0,
      progress: { fraction: 0.9, stage: 'late', seconds_left: null },
    });
    worker().finish();
    await second;
    expect(seen).toEqual(['1 x']);
  });

  it('cancels through the shared flag and keeps the worker', async () => {
    const wasm = backend(true);
    const abort = new AbortController();
    const running = wasm.run(job('a'), { signal: abort.signal });
    await until(() => worker().runs().length === 1);
    const load = worker().sent[0];
    const flag = new Int32Array(
      load?.type === 'load' && load.cancelFlag ? load.cancelFlag : new ArrayBuffer(4),
    );
    expect(flag[0]).toBe(0);
    abort.abort();
    expect(flag[0]).toBe(1);
    worker().say({
      type: 'failed',
      id: worker().runs()[0]?.id ?? 0,
      error: { code: 'cancelled', where: '', message: '' },
    });
    await expect(running).rejects.toMatchObject({ code: 'cancelled' });
    expect(workers).toHaveLength(1);
    expect(worker().ended).toBe(false);
  });

  it('ends the worker where no memory can be shared, and sends blobs anew to the next', async () => {
    const wasm = backend(false);
    const abort = new AbortController();
    const running = wasm.run(job('a'), { signal: abort.signal });
    await until(() => worker().runs().length === 1);
    abort.abort();
    await expect(running).rejects.toMatchObject({ code: 'cancelled' });
    expect(worker().ended).toBe(true);
    const again = wasm.run(job('a'));
    await until(() => workers.length === 2 && worker().runs().length === 1);
    worker().finish();
    await again;
    expect(read).toHaveBeenCalledTimes(2);
  });

  it('does not start a job that was cancelled while it waited', async () => {
    const wasm = backend();
    const first = wasm.run(job('a'));
    const abort = new AbortController();
    const second = wasm.run(job('a'), { signal: abort.signal });
    await until(() => worker().runs().length === 1);
    abort.abort();
    worker().finish();
    await first;
    await expect(second).rejects.toMatchObject({ code: 'cancelled' });
    expect(worker().runs()).toHaveLength(1);
  });

  it('keeps the worker after a plain failure, discards it when memory ran out', async () => {
    const wasm = backend();
    const unsolved = wasm.run(job('a'));
    await until(() => worker().runs().length === 1);
    worker().fail('could_not_solve');
    await expect(unsolved).rejects.toMatchObject({ code: 'could_not_solve' });
    expect(worker().ended).toBe(false);
    const large = wasm.run(job('a'));
    await until(() => worker().runs().length === 2);
    worker().fail('out_of_memory');
    await expect(large).rejects.toMatchObject({ code: 'out_of_memory' });
    expect(worker().ended).toBe(true);
  });

  it('fails a job whose solver ends between two inputs, and runs the next one', async () => {
    const wasm = backend();
    let second: (bytes: Uint8Array<ArrayBuffer>) => void = () => expect.fail('not asked for');
    read.mockImplementation((sha256) =>
      sha256 === hash('b')
        ? new Promise((resolve) => (second = resolve))
        : Promise.resolve(new Uint8Array([9])),
    );
    const two = job('a');
    const sheet = { sha256: hash('b'), file_name: 'b.obj' };
    const running = wasm.run({ ...two, inputs: { ...two.inputs, sheet } });
    await until(() => read.mock.calls.length === 2);
    worker().say({ type: 'failed', id: null, error: { code: 'out_of_memory', where: '', message: 'full' } });
    second(new Uint8Array([9]));
    await expect(running).rejects.toMatchObject({ code: 'out_of_memory' });
    const next = wasm.run(job('c'));
    await until(() => worker().runs().length === 1);
    worker().finish();
    expect((await next).report).toEqual({ vertices: 3 });
  });

  it('drops the oldest models from the heap', async () => {
    const wasm = backend();
    for (const digit of '0123456789') {
      const running = wasm.run(job(digit));
      await until(
        () =>
          worker().runs().at(-1)?.job.inputs['mesh'] !== undefined &&
          worker().runs().length === Number(digit) + 1,
      );
      worker().finish();
      await running;
    }
    const dropped = worker().sent.filter((message) => message.type === 'drop');
    expect(dropped.map(({ sha256 }) => sha256[0])).toEqual(['0', '1', '2', '3']);
  });
});
