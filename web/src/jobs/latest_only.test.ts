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

it('aborts a task that has run for longer than its patience when a newer one comes', async () => {
  const aborted: number[] = [];
  const queue = new LatestOnly<number>(
    (n, signal) =>
      new Promise((resolve) => {
        if (n > 0) resolve();
        signal.addEventListener('abort', () => {
          aborted.push(n);
          resolve();
        });
      }),
    0,
  );
  queue.request(0);
  await new Promise((resolve) => setTimeout(resolve, 5));
  queue.request(1);
  await turn();
  expect(aborted).toEqual([0]);
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
