// SPDX-License-Identifier: GPL-3.0-or-later
// @vitest-environment node
import { createHash } from 'node:crypto';
import { expect, test } from 'vitest';
import { JobError } from '../../jobs/contract';
import type { NativeConnection } from '../../jobs/native_connection';
import { runTask, uploadGcode } from './worker_tasks';

const file = new TextEncoder().encode('%PDF');
const sha256 = createHash('sha256').update(file).digest('hex');

/** Answers in order; keeps what was asked. */
function worker(states: readonly object[]) {
  const asked: { path: string; method: string; body: unknown }[] = [];
  let looks = 0;
  const answer = (path: string, init: RequestInit = {}) => {
    const { method = 'GET', body } = init;
    asked.push({ path, method, body: typeof body === 'string' ? JSON.parse(body) : (body ?? null) });
    return Promise.resolve(
      method === 'POST' && /\/(print|upload)$/.test(path)
        ? { id: 'j1' }
        : path.endsWith('/jobs/j1')
          ? states[Math.min(looks++, states.length - 1)]
          : {},
    );
  };
  const connection = { request: answer, requestOk: answer, json: answer } as unknown as NativeConnection;
  return { connection, asked };
}

test('the file goes first, then the order that names it, and the end is waited for', async () => {
  const { connection, asked } = worker([
    { id: 'j1', state: 'sending', sentence: 'Sending.', fraction: 0 },
    { id: 'j1', state: 'done', sentence: 'Done.', fraction: 1, result: { sheets: 2 } },
  ]);
  const seen: string[] = [];
  const result = await runTask(
    connection,
    'm 1',
    'print',
    file,
    { copies: 2 },
    {
      onTask: ({ state }) => seen.push(state),
      look_ms: 0,
    },
  );
  expect(result).toEqual({ sheets: 2 });
  expect(seen).toEqual(['sending', 'done']);
  expect(asked.slice(0, 2)).toEqual([
    { path: `blobs/${sha256}`, method: 'PUT', body: file },
    { path: 'machines/m%201/print', method: 'POST', body: { copies: 2, sha256 } },
  ]);
});

test('a print server starts only what is asked for, with its confirmation', async () => {
  const done = { id: 'j1', state: 'done', sentence: '', fraction: 1, result: { file_name: 'cat-1.gcode' } };
  for (const [start, rest] of [
    [false, {}],
    [true, { print: true, confirmed: true }],
  ] as const) {
    const { connection, asked } = worker([done]);
    expect(await uploadGcode(connection, 'm', file, 'cat.gcode', start)).toBe('cat-1.gcode');
    expect(asked[1]?.body).toEqual({ file_name: 'cat.gcode', sha256, ...rest });
  }
});

test('a failure is the worker’s sentence', async () => {
  const error = { code: 'could_not_solve', where: 'machine', message: 'Studio is out of paper.' };
  const { connection } = worker([{ id: 'j1', state: 'failed', sentence: '', fraction: 0, error }]);
  await expect(runTask(connection, 'm', 'print', file, {})).rejects.toThrow('Studio is out of paper.');
});

test('cancelling tells the worker', async () => {
  const { connection, asked } = worker([{ id: 'j1', state: 'printing', sentence: '', fraction: 0 }]);
  const abort = new AbortController();
  const run = runTask(
    connection,
    'm',
    'print',
    file,
    {},
    {
      signal: abort.signal,
      onTask: () => abort.abort(),
      look_ms: 1e6,
    },
  );
  await expect(run).rejects.toBeInstanceOf(JobError);
  expect(asked.at(-1)).toMatchObject({ path: 'machines/m/jobs/j1/cancel', method: 'POST' });
});
