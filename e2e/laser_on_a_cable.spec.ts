// SPDX-License-Identifier: GPL-3.0-or-later
// The page's own serial line, through the browser's real Web Serial: umockdev shows a USB adapter that is not there, its port is a
// pseudo-terminal, and behind that the virtual GRBL runs as a process of its own. Ending socat is pulling the cable.
import type { Browser, Page } from '@playwright/test';
import type { ChildProcess } from 'node:child_process';
import { spawn, spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { allow, browserOf, chip, confirm, forbid, hasUmockdev, plate } from './machine_bench';
import { address, backend, expect, fileOf, strip, test } from './page';

test.skip(backend !== 'wasm', 'the cable is the page’s own: solving does not come into it');

const laser = resolve(import.meta.dirname, '../build/tests/machines/virtual_grbl_stdio');

const device = (port: string) => `P: /devices/pci0000:00/0000:00:14.0/usb1/1-2
E: DEVTYPE=usb_device
E: DRIVER=usb
E: ID_MODEL=USB_Serial
E: ID_MODEL_ID=7523
E: ID_VENDOR=1a86
E: ID_VENDOR_ID=1a86
E: PRODUCT=1a86/7523/264
E: SUBSYSTEM=usb
A: idProduct=7523\\n
A: idVendor=1a86\\n

P: /devices/pci0000:00/0000:00:14.0/usb1/1-2/1-2:1.0/ttyUSB0/tty/ttyUSB0
E: DEVNAME=${port}
E: ID_BUS=usb
E: ID_MODEL=USB_Serial
E: ID_MODEL_ID=7523
E: ID_SERIAL=1a86_USB_Serial
E: ID_VENDOR_ID=1a86
E: MAJOR=4
E: MINOR=64
E: SUBSYSTEM=tty
A: dev=4:64\\n
`;

/** A browser that sees the adapter, and the cable to the laser. */
class Bench {
  readonly folder = mkdtempSync(join(tmpdir(), 'formwright-cable-'));
  readonly port = join(this.folder, 'laser');
  #cable: ChildProcess | null = null;
  #chromium: ChildProcess | null = null;
  browser: Browser | null = null;

  plugIn(): void {
    this.#cable = spawn('socat', [`PTY,link=${this.port},raw,echo=0`, `EXEC:${laser}`], { stdio: 'ignore' });
  }
  pull(): void {
    this.#cable?.kill();
  }

  async open(): Promise<Page> {
    const description = join(this.folder, 'adapter.umockdev');
    writeFileSync(description, device(this.port));
    const { browser, page } = await browserOf(this.folder, (words) => {
      this.#chromium = spawn('umockdev-run', ['-d', description, '--', ...words], {
        stdio: 'ignore',
        detached: true,
      });
    });
    this.browser = browser;
    return page;
  }

  async end(): Promise<void> {
    await this.browser?.close().catch(() => undefined);
    this.pull();
    if (this.#chromium?.pid !== undefined) spawnSync('kill', ['--', `-${this.#chromium.pid}`]);
    rmSync(this.folder, { recursive: true, force: true, maxRetries: 5 });
  }
}

test('a laser on a cable: connect, home, cut, hold, go on, and the cable pulled', async ({ baseURL }) => {
  test.skip(!hasUmockdev(), 'umockdev is not installed');
  expect(existsSync(laser)).toBe(true); // built with the native tests
  allow({ SerialAllowAllPortsForUrls: [baseURL] });
  const bench = new Bench();
  try {
    bench.plugIn();
    const page = await bench.open();
    await page.goto(`${baseURL}${address()}#/machines`);
    await page.getByLabel('Model or project file').setInputFiles(fileOf('plate.svg', plate));
    await expect(page.getByRole('contentinfo').getByText('Job ready').first()).toBeVisible();

    await page.getByRole('button', { name: 'Connect by cable' }).click();
    await expect(chip(page, 'Locked')).toBeVisible({ timeout: 20_000 });
    await expect(page.getByText('Speed of practice jobs')).toHaveCount(0); // a real machine has its own
    await expect(page.getByRole('button', { name: /^Start/ })).toHaveAttribute('aria-disabled', 'true');
    await page.locator('.machine-buttons').getByRole('button', { name: 'Home' }).click();
    await confirm(page, 'Home');
    await expect(chip(page, 'Ready')).toBeVisible({ timeout: 20_000 });
    // This laser homes to its upper right corner and counts down from there.
    await page.getByRole('button', { name: 'Set origin at the bed’s corner' }).click();
    await expect(page.locator('.machine-position')).toContainText('399.00');

    await page.getByRole('button', { name: 'Start', exact: true }).click();
    await confirm(page, 'Start with the laser on');
    await expect(chip(page, 'Working')).toBeVisible();
    await page.keyboard.press('Escape');
    await expect(chip(page, 'Paused')).toBeVisible();
    await page.getByRole('button', { name: 'Resume' }).click();
    await confirm(page, 'Resume');
    await expect(strip(page, 'plate is done')).toBeVisible({
      timeout: 90_000,
    });

    await page.getByRole('button', { name: 'Start', exact: true }).click();
    await confirm(page, 'Start with the laser on');
    await expect(chip(page, 'Working')).toBeVisible();
    await page.waitForTimeout(1500);
    bench.pull();
    await expect(page.getByText(/cable was unplugged.*unknown until the machine is homed/)).toBeVisible();
    await expect(chip(page, 'Offline')).toBeVisible();
    await page.getByRole('radio', { name: 'Console' }).click();
    await page.getByText('2 jobs so far').click();
    await expect(page.locator('.job-history li')).toHaveCount(2);
    await expect(page.locator('.job-history')).toContainText('cut off');
    await expect(page.locator('.job-history')).toContainText('done');

    // Plugged in again nothing goes on by itself; homed, the rest can be cut.
    await page.getByRole('radio', { name: 'Bed' }).click();
    const footer = page.getByRole('contentinfo');
    await expect(footer.locator('strong').getByText(/^Job cut off at \d+ %$/)).toBeVisible();
    bench.plugIn();
    await page.getByRole('button', { name: 'Connect by cable' }).click();
    await expect(chip(page, 'Locked')).toBeVisible({ timeout: 20_000 });
    await expect(footer.getByRole('button', { name: /^Cut the rest/ })).toHaveAttribute(
      'aria-disabled',
      'true',
    );
    await page.locator('.machine-buttons').getByRole('button', { name: 'Home' }).click();
    await confirm(page, 'Home');
    await expect(chip(page, 'Ready')).toBeVisible({ timeout: 20_000 });
    await page.getByRole('button', { name: 'Set origin at the bed’s corner' }).click();
    await footer.getByRole('button', { name: 'Cut the rest' }).click();
    await confirm(page, 'Continue with the laser on');
    await expect(footer.locator('strong').getByText('plate is done')).toBeVisible({ timeout: 90_000 });
  } finally {
    await bench.end();
    forbid();
  }
});
