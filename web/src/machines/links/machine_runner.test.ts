// SPDX-License-Identifier: GPL-3.0-or-later
// The built module behind the page's own runner, with the virtual machine and with ports of our making.
// @vitest-environment node
import { existsSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { afterEach, describe, expect, it } from 'vitest';
import type { FromMachineWorker, ToMachineWorker } from './machine_messages';
import type { Ports } from './machine_runner';
import { MachineRunner } from './machine_runner';
import type { MachineCommand, MachineState } from './machine_state';

const module = fileURLToPath(new URL('../../../public/wasm/machines.mjs', import.meta.url));
type WithoutId<T> = T extends { id: number } ? Omit<T, 'id'> : never;

class Page {
  readonly said: FromMachineWorker[] = [];
  readonly #runner: MachineRunner;
  #id = 0;
  constructor(ports: Ports = {}) {
    this.#runner = new MachineRunner((message) => this.said.push(message), ports);
  }
  /** The sentence of a refusal, or null. */
  async ask(message: WithoutId<ToMachineWorker>): Promise<string | null> {
    const id = ++this.#id;
    await this.#runner.handle({ ...message, id } as ToMachineWorker);
    const done = this.said.find((said) => said.type === 'done' && said.id === id);
    return done?.type === 'done' ? (done.error?.message ?? null) : 'no answer';
  }
  command = (command: MachineCommand) => this.ask({ type: 'command', command });
  get state(): MachineState {
    const last = this.said.findLast((said) => said.type === 'state');
    if (last?.type !== 'state') throw new Error('Nothing was told.');
    return last.state;
  }
  until = (reached: () => boolean, timeout = 15_000) =>
    expect.poll(() => reached(), { timeout, interval: 20 }).toBe(true);
}

describe.skipIf(!existsSync(module))('a machine in its worker', () => {
  let page = new Page();
  afterEach(() => page.ask({ type: 'close' }));

  it('homes, cuts and ends the virtual machine’s job', { timeout: 40_000 }, async () => {
    page = new Page();
    expect(
      await page.ask({ type: 'open', module, options: { controller: 'grbl' }, end: { kind: 'virtual' } }),
    ).toBeNull();
    // What the machine is like is said by its next report, which may come later than its answers.
    await page.until(() => page.state.connection === 'ready' && page.state.phase === 'alarm');
    expect(await page.command({ do: 'start', confirmed: true })).toMatch(/No job/);
    expect(await page.command({ do: 'home', confirmed: true })).toBeNull();
    await page.until(() => page.state.position_known && page.state.phase === 'idle');
    const job = new TextEncoder().encode('G21G90\nM4S300\nG0X20Y20\nG1X30F6000\nG1X40\nM5\n');
    expect(await page.ask({ type: 'load', name: 'line.gcode', job })).toBeNull();
    expect(await page.command({ do: 'start', confirmed: false })).toMatch(/confirmed/);
    expect(await page.command({ do: 'start', confirmed: true })).toBeNull();
    await page.until(() => page.state.job?.ended === 'done');
    expect(page.state.work_mm?.[0]).toBeCloseTo(40, 3);
    const events = page.said.flatMap((said) => (said.type === 'state' ? said.events : []));
    expect(events.some(({ event, text }) => event === 'sent' && text === 'G1X40')).toBe(true);
  });

  /** Ready for a job of two strokes of 30 mm at 10 mm/s: six seconds of a real machine. */
  async function readyForJob(): Promise<void> {
    page = new Page();
    await page.ask({ type: 'open', module, options: { controller: 'grbl' }, end: { kind: 'virtual' } });
    await page.until(() => page.state.connection === 'ready' && page.state.phase === 'alarm');
    await page.command({ do: 'home', confirmed: true });
    await page.until(() => page.state.position_known && page.state.phase === 'idle');
    const job = new TextEncoder().encode('G21G90\nM4S300\nG0X20Y20\nG1X50F600\nG1Y50\nM5\n');
    await page.ask({ type: 'load', name: 'line.gcode', job });
  }
  const pace = () => {
    const last = page.said.findLast((said) => said.type === 'state');
    return last?.type === 'state' ? last.pace : undefined;
  };
  /** Seconds on the wall and of the machine. */
  async function runIt(during: () => Promise<void> = () => Promise.resolve()): Promise<[number, number]> {
    const start_ms = performance.now();
    expect(await page.command({ do: 'start', confirmed: true })).toBeNull();
    await during();
    await page.until(() => page.state.job?.ended === 'done');
    return [(performance.now() - start_ms) / 1000, page.state.job?.seconds ?? 0];
  }

  it('a practice job takes as long in the machine’s time at every speed', { timeout: 60_000 }, async () => {
    await readyForJob();
    const [slow_s, real_s] = await runIt();
    expect(real_s).toBeGreaterThan(6);
    expect(Math.abs(slow_s - real_s)).toBeLessThan(0.2 * real_s + 0.5);
    for (const speed of [4, 16, Infinity]) {
      expect(await page.ask({ type: 'speed', speed })).toBeNull();
      const [wall_s, machine_s] = await runIt();
      expect(wall_s).toBeLessThan(0.6 * slow_s);
      expect(Math.abs(machine_s - real_s)).toBeLessThan(0.5);
      expect(page.state.work_mm?.[1]).toBeCloseTo(50, 3);
    }
    // In the middle of a run: faster, slower, faster.
    const [wall_s, machine_s] = await runIt(async () => {
      for (const speed of [4, 1, 16]) {
        expect(await page.ask({ type: 'speed', speed })).toBeNull();
        await new Promise((resolve) => setTimeout(resolve, 250));
      }
    });
    expect(wall_s).toBeLessThan(0.6 * slow_s);
    expect(Math.abs(machine_s - real_s)).toBeLessThan(0.5);
  });

  it('a stop is obeyed at once, and a pause lasts as long as on the wall', { timeout: 60_000 }, async () => {
    await readyForJob();
    const job = new TextEncoder().encode('G21G90\nM4S300\n' + 'G1X50F600\nG1X20\n'.repeat(2000));
    await page.ask({ type: 'load', name: 'long.gcode', job });
    expect(await page.ask({ type: 'speed', speed: Infinity })).toBeNull();
    expect(await page.command({ do: 'start', confirmed: true })).toBeNull();
    await page.until(() => (page.state.job?.seconds ?? 0) > 30);
    await page.until(() => (pace() ?? 0) > 4); // on a busy computer less than on an idle one
    expect(await page.command({ do: 'pause' })).toBeNull();
    await page.until(() => page.state.phase === 'paused');
    const before = page.state.job?.seconds ?? 0;
    await new Promise((resolve) => setTimeout(resolve, 1000));
    const paused_s = (page.state.job?.seconds ?? 0) - before;
    expect(paused_s).toBeGreaterThan(0.5);
    expect(paused_s).toBeLessThan(2);
    expect(await page.command({ do: 'resume', confirmed: true })).toBeNull();
    await page.until(() => (page.state.job?.seconds ?? 0) > before + 60);
    const stopped_ms = performance.now();
    expect(await page.command({ do: 'stop' })).toBeNull();
    expect(performance.now() - stopped_ms).toBeLessThan(200);
    expect(page.state.job?.ended).toBe('stopped');
    expect(page.state.job?.acknowledged).toBeLessThan(4000);
    await page.until(() => ['idle', 'alarm'].includes(page.state.phase));
    expect(page.state.laser_on).not.toBe(true);
  });

  it('a real machine has the wall’s time, and no other', async () => {
    const port = {
      readable: new ReadableStream<Uint8Array>(),
      writable: new WritableStream<Uint8Array>(),
      open: () => Promise.resolve(),
      close: () => Promise.resolve(),
      getInfo: () => ({}),
    };
    page = new Page({ serial: { getPorts: () => Promise.resolve([port]) } });
    await page.ask({ type: 'open', module, options: {}, end: { kind: 'serial', index: 0, baud: 115200 } });
    expect(await page.ask({ type: 'speed', speed: 16 })).toBe(
      'Only a practice machine can run faster than real.',
    );
    expect(pace()).toBeUndefined();
  });

  it('says that a port is gone, and what that means', { timeout: 20_000 }, async () => {
    const written: string[] = [];
    const opened: ReadableStreamDefaultController<Uint8Array>[] = [];
    const port = {
      readable: new ReadableStream<Uint8Array>({ start: (controller) => void opened.push(controller) }),
      writable: new WritableStream<Uint8Array>({
        write: (bytes) => void written.push(new TextDecoder().decode(bytes)),
      }),
      open: () => Promise.resolve(),
      close: () => Promise.resolve(),
      getInfo: () => ({}),
    };
    page = new Page({ serial: { getPorts: () => Promise.resolve([port]) } });
    expect(
      await page.ask({ type: 'open', module, options: {}, end: { kind: 'serial', index: 1, baud: 115200 } }),
    ).toMatch(/no longer connected/);
    expect(
      await page.ask({ type: 'open', module, options: {}, end: { kind: 'serial', index: 0, baud: 115200 } }),
    ).toBeNull();
    const say = (text: string) => opened[0]?.enqueue(new TextEncoder().encode(text));
    say("Grbl 1.1h ['$' for help]\r\n");
    await page.until(() => written.includes('$I\n'));
    say('[VER:1.1h.20190825:]\r\nok\r\n');
    await page.until(() => written.includes('$$\n'));
    say('$22=0\r\n$30=1000\r\nok\r\n<Idle|MPos:0.000,0.000,0.000|FS:0,0>\r\n');
    await page.until(() => page.state.phase === 'idle');
    opened[0]?.error(new DOMException('gone', 'NetworkError'));
    await page.until(() => page.said.some(({ type }) => type === 'gone'));
    expect(page.state.connection).toBe('closed');
    expect(page.state.position_known).toBe(false);
  });
});
