// SPDX-License-Identifier: GPL-3.0-or-later
// What a K40's board hears over WebUSB, byte for byte, at the browser's own boundary: a CH341 with an M2Nano behind it,
// of our making, in place of navigator.usb.
// @vitest-environment node
import { existsSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { afterEach, describe, expect, it } from 'vitest';
import type { FromMachineWorker, ToMachineWorker } from './machine_messages';
import { MachineRunner } from './machine_runner';
import type { MachineState } from './machine_state';

const module = fileURLToPath(new URL('../../../public/wasm/machines.mjs', import.meta.url));

/** Of Dallas and Maxim, by table as in their application note 27: bits from the low end. */
const crcTable = Array.from({ length: 256 }, (_, byte) => {
  let crc = byte;
  for (let bit = 0; bit < 8; ++bit) crc = crc & 1 ? (crc >> 1) ^ 0x8c : crc >> 1;
  return crc;
});
const crcOf = (bytes: Uint8Array) => bytes.reduce((crc, byte) => crcTable[crc ^ byte] ?? 0, 0);

class Board {
  readonly vendorId = 0x1a86;
  readonly productId = 0x5512;
  readonly said: string[] = [];
  readonly packets: string[] = [];
  /** The next so many packets arrive with a bit fallen over. */
  spoil = 0;
  status = 206;
  #finishedAfter = -1;

  open = () => this.#say('open');
  close = () => this.#say('close');
  selectConfiguration = (value: number) => this.#say(`configuration ${value}`);
  claimInterface = (number: number) => this.#say(`claim ${number}`);
  releaseInterface = (number: number) => this.#say(`release ${number}`);
  controlTransferOut = (setup: object) => {
    void this.#say(`control ${JSON.stringify(setup)}`);
    return Promise.resolve({ status: 'ok' });
  };
  transferOut = (endpoint: number, data: BufferSource) => {
    const bytes = new Uint8Array((data as Uint8Array).slice());
    expect(endpoint).toBe(2);
    if (bytes.length === 1 && bytes[0] === 0xa0) return Promise.resolve({ status: 'ok' });
    // The chip takes 32 bytes at once: a command byte and up to 31 for the port.
    expect([bytes.length, bytes[0], bytes[1], bytes[32]]).toEqual([34, 0xa6, 0, 0xa6]);
    const letters = bytes.slice(2, 32);
    if (this.spoil > 0) {
      --this.spoil;
      letters[7] = (letters[7] ?? 0) ^ 0x10;
    }
    if (crcOf(letters) === bytes[33]) {
      this.status = 206;
      this.packets.push(new TextDecoder().decode(letters));
      if (this.packets.at(-1)?.includes('FNSE')) this.#finishedAfter = 8;
    } else this.status = 207;
    return Promise.resolve({ status: 'ok' });
  };
  transferIn = (endpoint: number, length: number) => {
    expect([endpoint, length]).toEqual([2, 32]);
    if (this.#finishedAfter > 0 && --this.#finishedAfter === 0) this.status = 236;
    return Promise.resolve({
      status: 'ok',
      data: new DataView(Uint8Array.of(255, this.status, 111, 8, 19, 0).buffer),
    });
  };
  #say(what: string): Promise<void> {
    this.said.push(what);
    return Promise.resolve();
  }
}

describe.skipIf(!existsSync(module))('a K40 over WebUSB', () => {
  let board = new Board();
  const said: FromMachineWorker[] = [];
  let runner = new MachineRunner((message) => said.push(message), {});
  let id = 0;
  type WithoutId<T> = T extends { id: number } ? Omit<T, 'id'> : never;
  const ask = async (message: WithoutId<ToMachineWorker>) => {
    const own = ++id;
    await runner.handle({ ...message, id: own } as ToMachineWorker);
    const done = said.find((one) => one.type === 'done' && one.id === own);
    expect(done?.type === 'done' ? done.error : 'no answer').toBeNull();
  };
  const state = (): MachineState | null => {
    const last = said.findLast((one) => one.type === 'state');
    return last?.type === 'state' ? last.state : null;
  };
  const until = (reached: () => boolean) =>
    expect.poll(reached, { timeout: 15_000, interval: 20 }).toBe(true);
  afterEach(() => ask({ type: 'close' }));

  it('sends a job whole, in order, through packets that arrive spoiled', { timeout: 40_000 }, async () => {
    board = new Board();
    runner = new MachineRunner((message) => said.push(message), {
      usb: { getDevices: () => Promise.resolve([board]) },
    });
    await ask({ type: 'open', module, options: { controller: 'k40' }, end: { kind: 'usb', index: 0 } });
    // Vendor request 177 sets the chip to its parallel mode (EPP 1.9).
    const epp = { requestType: 'vendor', recipient: 'device', request: 177, value: 0x0102, index: 0 };
    expect(board.said).toEqual(['open', 'configuration 1', 'claim 0', `control ${JSON.stringify(epp)}`]);
    await until(() => state()?.phase === 'idle');
    await ask({ type: 'command', command: { do: 'home', confirmed: true } });
    await until(() => state()?.position_known === true);
    expect(board.packets).toEqual(['IPP'.padEnd(30, 'F')]);

    const body = `ICV1752241000000003CNBRS1E${'DaRbUcLd'.repeat(20)}\nFNSE-\n`;
    await ask({ type: 'load', name: 'job.egv', job: new TextEncoder().encode(body) });
    board.spoil = 3;
    await ask({ type: 'command', command: { do: 'start', confirmed: true } });
    await until(() => state()?.job?.ended === 'done');
    expect(
      board.packets
        .slice(1)
        .join('')
        .replace(/F+(?=FNSE)/, '')
        .replace(/F+$/, ''),
    ).toBe(body.replace(/[\n-]/g, ''));
    expect(board.spoil).toBe(0);
  });

  it('stops with one packet that overtakes', { timeout: 20_000 }, async () => {
    board = new Board();
    runner = new MachineRunner((message) => said.push(message), {
      usb: { getDevices: () => Promise.resolve([board]) },
    });
    await ask({ type: 'open', module, options: { controller: 'k40' }, end: { kind: 'usb', index: 0 } });
    await until(() => state()?.phase === 'idle');
    await ask({ type: 'command', command: { do: 'home', confirmed: true } });
    await until(() => state()?.position_known === true);
    const body = `ICV1752241000000003CNBRS1E${'DBaUTa'.repeat(14_000)}`;
    await ask({ type: 'load', name: 'long.egv', job: new TextEncoder().encode(body) });
    await ask({ type: 'command', command: { do: 'start', confirmed: true } });
    await until(() => board.packets.length > 5);
    await ask({ type: 'command', command: { do: 'stop' } });
    await until(() => board.packets.at(-1) === 'I'.padEnd(30, 'F'));
    const count = board.packets.length;
    await new Promise((done) => setTimeout(done, 500));
    expect(board.packets.length).toBe(count);
    expect(state()?.position_known).toBe(false);
  });
});
