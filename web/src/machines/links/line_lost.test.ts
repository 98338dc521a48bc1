// SPDX-License-Identifier: GPL-3.0-or-later
// What becomes of port and device when a line is lost: the runner and the ends with a driver of our making, which
// needs no built module.
// @vitest-environment node
import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import type { FromMachineWorker, ToMachineWorker } from './machine_messages';
import type { MachineCall } from './machine_module';
import type { Ports } from './machine_runner';
import { MachineRunner } from './machine_runner';

const ask = Uint8Array.of(0xa0); // a K40's status
const stop = Uint8Array.of(0xa6, 0);
const driver = vi.hoisted(() => ({ broken: false }));

/** Asks at every opening and stop, as a K40's does; says nothing on closing. */
vi.mock('./machine_module', async (original) => {
  class FakeModule {
    static load = () => Promise.resolve(new FakeModule());
    newDriver = () => 1;
    call(_: number, { call }: MachineCall) {
      if (driver.broken) throw new WebAssembly.RuntimeError('unreachable');
      const packets = call === 'opened' ? [ask] : call === 'command' ? [stop, ask] : [];
      const events = call === 'closed' ? [{ event: 'ended', how: 'cut_off', now_s: 0 }] : [];
      return { state: { phase: call }, events, packets };
    }
  }
  return { ...(await original<object>()), MachineModule: FakeModule };
});

function running(ports: object) {
  const said: FromMachineWorker[] = [];
  const runner = new MachineRunner((message) => said.push(message), ports as Ports);
  const tell = (message: object) => runner.handle({ id: 1, ...message } as ToMachineWorker);
  return { said, tell, gone: () => said.find(({ type }) => type === 'gone') };
}

/** Takes what is written and never answers. */
const stalledLaser = () => {
  const log: string[] = [];
  let pull = () => {};
  const note = (what: string) => () => Promise.resolve(void log.push(what));
  const device = {
    open: note('open'),
    selectConfiguration: note('configure'),
    claimInterface: note('claim'),
    controlTransferOut: note('initialise'),
    transferOut: (_: number, packet: Uint8Array) =>
      Promise.resolve(void log.push(packet[0] === ask[0] ? 'ask' : 'stop')),
    transferIn: () =>
      new Promise<never>((_, reject) => {
        pull = () => reject(new DOMException('gone', 'NetworkError'));
      }),
    releaseInterface: note('release'),
    close: note('close'),
  };
  return { log, pull: () => pull(), usb: { getDevices: () => Promise.resolve([device]) } };
};
const openLaser = { type: 'open', module: '', options: {}, end: { kind: 'usb', index: 0 } };

beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  driver.broken = false;
  vi.useRealTimers();
});

test('a laser that does not answer still gets the stop, then the device is given back', async () => {
  const { log, usb } = stalledLaser();
  const { said, tell, gone } = running({ usb });
  await tell(openLaser);
  await tell({ type: 'command', command: { do: 'stop' } });
  await vi.advanceTimersByTimeAsync(4900);
  expect(gone()).toBeUndefined();
  await vi.advanceTimersByTimeAsync(200);
  expect(gone()).toEqual({
    type: 'gone',
    why: 'The laser does not answer: check that it is on and its cable plugged in.',
  });
  // How the job ended is told before.
  const lost = said.findIndex(
    (one) => one.type === 'state' && one.events.some(({ how }) => how === 'cut_off'),
  );
  expect(lost).toBeGreaterThan(-1);
  expect(lost).toBeLessThan(said.findIndex(({ type }) => type === 'gone'));

  await tell({ type: 'close' });
  expect(log.slice(4)).toEqual(['ask', 'stop', 'release', 'close']);
  expect(said.filter(({ type }) => type === 'gone')).toHaveLength(1);
});

test('a serial port that cannot be written to is closed', async () => {
  let closed = false;
  const port = {
    readable: new ReadableStream<Uint8Array>(),
    writable: new WritableStream<Uint8Array>({ write: () => Promise.reject(new Error('broken')) }),
    open: () => Promise.resolve(),
    close: () => Promise.resolve(void (closed = true)),
  };
  const { tell, gone } = running({ serial: { getPorts: () => Promise.resolve([port]) } });
  await tell({ ...openLaser, end: { kind: 'serial', index: 0, baud: 115200 } });
  await vi.advanceTimersByTimeAsync(100);
  expect(gone()).toEqual({
    type: 'gone',
    why: 'The connection was lost while sending: check the cable and connect again.',
  });
  await tell({ type: 'close' });
  expect(closed).toBe(true);
});

test('where the driver broke too, the page hears that the line is gone', async () => {
  const { log, pull, usb } = stalledLaser();
  const { tell, gone } = running({ usb });
  await tell(openLaser);
  await vi.advanceTimersByTimeAsync(0); // its question is on its way
  driver.broken = true;
  pull();
  await vi.advanceTimersByTimeAsync(0);
  expect(gone()).toEqual({ type: 'gone', why: 'The cable was unplugged, or the laser switched off.' });
  await tell({ type: 'close' });
  expect(log.at(-1)).toBe('close');
});
