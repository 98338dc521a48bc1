// SPDX-License-Identifier: GPL-3.0-or-later
// A K40 through the browser's real WebUSB: umockdev shows a CH341 that is not there, and usb_k40.py answers what the browser asks of the
// kernel, with a board of ours behind it.
import type { Browser, Page } from '@playwright/test';
import type { ChildProcessWithoutNullStreams } from 'node:child_process';
import { spawn, spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { createInterface } from 'node:readline';
import { allow, browserOf, chip, confirm, forbid, hasUmockdev, plate } from './machine_bench';
import { address, backend, expect, fileOf, strip, test } from './page';

test.skip(backend !== 'wasm', 'the cable is the page’s own: solving does not come into it');

const board = resolve(import.meta.dirname, 'usb_k40.py');
const python = '/usr/bin/python3'; // Debian's own, which has Debian's GObject introspection
const hasIntrospection = () =>
  spawnSync('umockdev-wrapper', [
    python,
    '-c',
    'import gi; gi.require_version("UMockdev", "1.0"); from gi.repository import UMockdev',
  ]).status === 0;

interface Heard {
  readonly packet?: string;
  readonly good?: boolean;
  readonly control?: readonly number[];
  readonly strange?: string;
  readonly mishap?: string;
}

/** A browser that sees the laser, and what the laser hears. */
class Bench {
  readonly folder = mkdtempSync(join(tmpdir(), 'formwright-usb-'));
  readonly heard: Heard[] = [];
  #laser: ChildProcessWithoutNullStreams | null = null;
  browser: Browser | null = null;

  async open(): Promise<Page> {
    const { browser, page } = await browserOf(this.folder, (words) => {
      this.#laser = spawn('umockdev-wrapper', [python, board, ...words]);
      this.#laser.stderr.resume();
      createInterface(this.#laser.stdout).on('line', (line) => this.heard.push(JSON.parse(line) as Heard));
    });
    this.browser = browser;
    return page;
  }
  tell = (words: string) => this.#laser?.stdin.write(`${words}\n`);
  packets = () => this.heard.flatMap(({ packet, good }) => (packet !== undefined && good ? [packet] : []));
  spoiled = () => this.heard.filter(({ good }) => good === false).length;
  mishaps = () => this.heard.filter(({ strange, mishap }) => (strange ?? mishap) !== undefined);

  async end(): Promise<void> {
    await this.browser?.close().catch(() => undefined);
    const laser = this.#laser;
    if (laser !== null && laser.exitCode === null) {
      const ended = new Promise((done) => laser.once('exit', done));
      laser.stdin.end();
      await ended;
    }
    rmSync(this.folder, { recursive: true, force: true, maxRetries: 5 });
  }
}

/** Letters without what fills packets: F is used by no command but FNSE, the end. */
const letters = (text: string) => text.replace(/[F\r\n-]/g, '');

test('a K40 on USB: connect, home, cut through spoiled packets, and the cable pulled', async ({
  baseURL,
}) => {
  test.skip(!hasUmockdev(), 'umockdev is not installed');
  test.skip(!hasIntrospection(), 'gir1.2-umockdev-1.0 or python3-gi is not installed');
  allow({
    WebUsbAllowDevicesForUrls: [{ devices: [{ vendor_id: 0x1a86, product_id: 0x5512 }], urls: [baseURL] }],
  });
  const bench = new Bench();
  try {
    const page = await bench.open();
    await page.goto(`${baseURL}${address()}#/machines`);
    await page.locator('.profile-button').click();
    await page.getByRole('menuitem', { name: 'Add a machine' }).click();
    const dialog = page.getByRole('dialog');
    await dialog.getByLabel('Name').fill('K40');
    await dialog.getByLabel('Kind').selectOption({ label: 'K40 laser (M2Nano)' });
    await dialog.getByLabel('Bed width, mm').fill('300');
    await dialog.getByLabel('Bed depth, mm').fill('200');
    await dialog.getByRole('button', { name: 'Add', exact: true }).click();
    await page.getByLabel('Model or project file').setInputFiles(fileOf('plate.svg', plate));
    await expect(page.getByRole('contentinfo').getByText('Job ready').first()).toBeVisible();
    const waiting = page.waitForEvent('download');
    await page.getByRole('button', { name: 'Job file' }).click();
    const file = join(bench.folder, 'plate.egv');
    await (await waiting).saveAs(file);
    const body = /%[^%\n]*\r?\n?([^%]*)$/.exec(readFileSync(file, 'latin1'))?.[1] ?? '';
    expect(body).toContain('FNSE');

    await page.getByRole('button', { name: 'Connect by USB' }).click();
    await expect(chip(page, 'Ready')).toBeVisible({ timeout: 20_000 });
    // Vendor request 177 sets the chip to its parallel mode.
    expect(bench.heard.find(({ control }) => control !== undefined)?.control).toEqual([0x40, 177, 0x0102, 0]);
    await expect(page.getByRole('button', { name: /^Start/ })).toHaveAttribute('aria-disabled', 'true');
    await page.locator('.machine-buttons').getByRole('button', { name: 'Home' }).click();
    await confirm(page, 'Home');
    await expect(page.getByRole('button', { name: 'Start', exact: true })).not.toHaveAttribute(
      'aria-disabled',
      'true',
      { timeout: 20_000 },
    );
    expect(bench.packets()).toEqual(['IPP'.padEnd(30, 'F')]);

    bench.tell('spoil 3');
    await page.getByRole('button', { name: 'Start', exact: true }).click();
    await confirm(page, 'Start with the laser on');
    await expect(strip(page, 'plate is done')).toBeVisible({
      timeout: 90_000,
    });
    expect(letters(bench.packets().slice(1).join(''))).toBe(letters(body));
    expect(bench.spoiled()).toBe(3);

    const before = bench.packets().length;
    await page.getByRole('button', { name: 'Start', exact: true }).click();
    await confirm(page, 'Start with the laser on');
    await expect.poll(() => bench.packets().length).toBeGreaterThan(before);
    bench.tell('pull');
    await expect(chip(page, 'Offline')).toBeVisible();
    await page.getByRole('radio', { name: 'Console' }).click();
    await page.getByText('2 jobs so far').click();
    await expect(page.locator('.job-history')).toContainText('cut off');
    await expect(page.locator('.job-history')).toContainText('done');
    expect(bench.mishaps()).toEqual([]);
  } finally {
    await bench.end();
    forbid();
  }
});
