// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import { LatestOnly } from './latest_only';

const deferred = () => {
  let resolve!: () => void;
  const promise = new Promise<void>((done) => (resolve = done));
  return { promise, resolve };
};
const turn = () => new Promise((resolve) => setTimeout(resolve, 0));

it('runs the first and the last of a burst and nothing between', async () => {
  const ran: number[] = [];
  const first = deferred();
  const queue = new LatestOnly<number>(async (n) => {
    ran.push(n);
    if (n === 0) await first.promise;
  });
  for (let n = 0; n < 10; ++n) queue.request(n);
  expect(ran).toEqual([0]);
  expect(queue.busy).toBe(true);
  first.resolve();
  await turn();
  expect(ran).toEqual([0, 9]);
  expect(queue.busy).toBe(false);
});

it('aborts only what is of no use to the newer request', async () => {
  const aborted: string[] = [];
  const gates: (() => void)[] = [];
  const queue = new LatestOnly<string>(
    (name, signal) =>
      new Promise((resolve) => {
        gates.push(resolve);
        signal.addEventListener('abort', () => {
          aborted.push(name);
          resolve();
        });
      }),
    (running, next) => running[0] !== next[0],
  );
  queue.request('a1');
  queue.request('a2'); // another thickness: what runs is of use to it
  expect(aborted).toEqual([]);
  queue.request('b1'); // another model
  expect(aborted).toEqual(['a1']);
  await turn();
  gates.at(-1)?.();
  await turn();
  expect(queue.busy).toBe(false);
  expect(gates).toHaveLength(2);
});

it('goes on after a task that throws, and drops what waits when cancelled', async () => {
  const ran: string[] = [];
  const queue = new LatestOnly<string>(async (name) => {
    ran.push(name);
    await turn();
    throw new Error(name);
  });
  queue.request('a');
  queue.request('b');
  await turn();
  await turn();
  expect(ran).toEqual(['a', 'b']);
  queue.request('c');
  queue.cancel();
  await new Promise((resolve) => setTimeout(resolve, 10));
  queue.request('d');
  expect(ran.at(-1)).toBe('d');
});

it('does not run again what is running', async () => {
  const ran: string[] = [];
  const gate = deferred();
  const queue = new LatestOnly<string>(
    async (name) => {
      ran.push(name);
      await gate.promise;
    },
    undefined,
    (running, next) => running === next,
  );
  queue.request('a');
  queue.request('b');
  queue.request('a');
  gate.resolve();
  await turn();
  expect(ran).toEqual(['a']);
});
