// SPDX-License-Identifier: GPL-3.0-or-later
// The page's side of a line; the Web Worker is of our making.
// @vitest-environment happy-dom
import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { WorkerLink } from './machine_link';
import type { FromMachineWorker, ToMachineWorker } from './machine_messages';

class FakeWorker extends EventTarget {
  static all: FakeWorker[] = [];
  readonly asked: ToMachineWorker[] = [];
  alive = true;
  constructor() {
    super();
    FakeWorker.all.push(this);
  }
  postMessage(message: ToMachineWorker): void {
    this.asked.push(message);
    if (message.type === 'open') this.answer();
  }
  terminate(): void {
    this.alive = false;
  }
  say(data: FromMachineWorker): void {
    this.dispatchEvent(new MessageEvent('message', { data }));
  }
  /** To what was asked last. */
  answer(error: string | null = null): void {
    const id = this.asked.at(-1)?.id ?? 0;
    this.say({ type: 'done', id, error: error === null ? null : { code: '', where: '', message: error } });
  }
  get askedLast(): string | undefined {
    return this.asked.at(-1)?.type;
  }
}

const connect = async () => {
  const link = await WorkerLink.open({ kind: 'usb', index: 0 }, {});
  return { link, worker: FakeWorker.all.at(-1) as FakeWorker };
};
const settle = () => vi.advanceTimersByTimeAsync(0);

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal('Worker', FakeWorker);
});
afterEach(async () => {
  await vi.advanceTimersByTimeAsync(60_000);
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

test('a worker whose line is gone closes it and ends; only then the next one opens the device', async () => {
  const { link, worker } = await connect();
  const stopping = link.command({ do: 'stop' });
  worker.say({
    type: 'gone',
    why: 'The laser does not answer: check that it is on and its cable plugged in.',
  });
  expect(link.gone.value).toBe('The laser does not answer: check that it is on and its cable plugged in.');
  await expect(stopping).rejects.toThrow('does not answer');
  expect(worker).toMatchObject({ askedLast: 'close', alive: true }); // the stop may still be on its way

  const again = connect();
  await settle();
  expect(FakeWorker.all.at(-1)).toBe(worker);
  worker.answer();
  expect((await again).worker).not.toBe(worker);
  expect(worker.alive).toBe(false);
});

test('a worker that does not get its line closed is ended', async () => {
  const { worker } = await connect();
  worker.say({
    type: 'gone',
    why: 'The connection was lost while sending: check the cable and connect again.',
  });
  await vi.advanceTimersByTimeAsync(5500);
  expect(worker.alive).toBe(true); // a transfer may take five seconds, and a stop wait behind it
  await vi.advanceTimersByTimeAsync(1000);
  expect(worker.alive).toBe(false);
});

test('a driver that broke gives its device back', async () => {
  const { link, worker } = await connect();
  worker.dispatchEvent(new Event('error'));
  expect(link.gone.value).toMatch(/stopped unexpectedly/);
  expect(worker.askedLast).toBe('close');
  worker.answer('The driver is broken.');
  await settle();
  expect(worker.alive).toBe(false);
});

test('closed from here nothing is said to be wrong, and a line that breaks meanwhile is asked once', async () => {
  const { link, worker } = await connect();
  let closed = link.close();
  worker.say({ type: 'gone', why: null });
  worker.answer();
  await closed;
  expect(link.gone.value).toBe('');
  expect(worker.alive).toBe(false);

  const other = await connect();
  closed = other.link.close();
  other.worker.say({
    type: 'gone',
    why: 'The laser does not answer: check that it is on and its cable plugged in.',
  });
  await settle();
  expect(other.worker.alive).toBe(true);
  other.worker.answer();
  await closed;
  expect(other.worker.asked.filter(({ type }) => type === 'close')).toHaveLength(1);
  expect(other.worker.alive).toBe(false);
});

test('a worker that cannot open its line ends at once', async () => {
  const answer = vi.spyOn(FakeWorker.prototype, 'postMessage').mockImplementation(function (
    this: FakeWorker,
    message,
  ) {
    this.asked.push(message);
    this.answer('It is held by another program.');
  });
  await expect(connect()).rejects.toThrow('another program');
  answer.mockRestore();
  expect(FakeWorker.all.at(-1)?.alive).toBe(false);
  await connect();
});
