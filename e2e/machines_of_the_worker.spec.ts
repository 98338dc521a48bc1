// SPDX-License-Identifier: GPL-3.0-or-later
// Machines that only the worker reaches: a laser at a serial port of its computer, a slicer, a print server.
import type { Page } from '@playwright/test';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { backend, expect, fileOf, goToRoom, openPage, openSampleIn, strip, test } from './page';
import { addMachine, isInstalled, Peer, removeMachine } from './worker_peers';

test.skip(backend !== 'native', 'a page alone reaches none of them');

const square = fileOf(
  'plate.svg',
  `<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="40mm" viewBox="0 0 60 40">
<g id="cut" stroke="#ff0000" fill="none"><rect x="5" y="5" width="50" height="30"/></g></svg>`,
);
const chip = (page: Page) => page.locator('.state-chip');
const confirm = (page: Page, name: string) =>
  page.getByRole('dialog').getByRole('button', { name, exact: true }).click();

test('a laser at the worker’s port: connect, home, cut, stop; a page that goes leaves it held', async ({
  page,
}) => {
  test.setTimeout(300_000);
  const laser = new Peer();
  try {
    addMachine('Shed', `serial:${await laser.startLaser()}`, '--controller', 'grbl');
    await openPage(page);
    await goToRoom(page, 'Machines');
    await page.getByLabel('Model or project file').setInputFiles(square);
    await expect(strip(page, 'Job ready')).toBeVisible();
    await page.getByRole('button', { name: 'Shed, through the worker' }).click();
    await expect(chip(page)).toHaveText('Locked', { timeout: 20_000 });
    await page.locator('.machine-buttons').getByRole('button', { name: 'Home' }).click();
    await confirm(page, 'Home');
    await expect(chip(page)).toHaveText('Ready', { timeout: 30_000 });
    await page.getByRole('button', { name: 'Set origin at the bed’s corner' }).click();
    const start = page.locator('.inspector-foot').getByRole('button', { name: /^Start/ });
    await expect(start).toBeEnabled();
    await start.click();
    await confirm(page, 'Start with the laser on');
    await expect(chip(page)).toHaveText('Working');
    await page.keyboard.press('Control+.'); // Stop, wherever the focus is
    await expect(chip(page)).toHaveText(/^(Locked|Alarm.*|Stopped)$/, { timeout: 10_000 });
    await page.locator('.machine-buttons').getByRole('button', { name: 'Home' }).click();
    await confirm(page, 'Home');
    await expect(chip(page)).toHaveText('Ready', { timeout: 30_000 });
    await start.click();
    await confirm(page, 'Start with the laser on');
    await expect(strip(page, 'plate is done')).toBeVisible({ timeout: 120_000 });

    // The tab is closed in the middle of a job: the worker holds the machine, the next page is told.
    await start.click();
    await confirm(page, 'Start with the laser on');
    await expect(chip(page)).toHaveText('Working');
    await page.reload();
    await goToRoom(page, 'Machines');
    await page.getByRole('button', { name: 'Shed, through the worker' }).click();
    await expect(chip(page)).toHaveText('Paused', { timeout: 20_000 });
    await page.getByRole('button', { name: 'Resume' }).click();
    await confirm(page, 'Resume');
    await expect(chip(page)).toHaveText('Ready', { timeout: 120_000 });
  } finally {
    removeMachine('Shed');
    await laser.end();
  }
});

test('a mould is sliced and sent to a print server, and started only when that is confirmed', async ({
  page,
}) => {
  test.skip(!isInstalled('prusa-slicer'), 'PrusaSlicer is not installed');
  test.setTimeout(420_000);
  const peer = new Peer();
  try {
    const server = await peer.startProgram<{ url: string; key: string }>('octoprint', 5638);
    const key = join(peer.folder, 'key.txt');
    writeFileSync(key, server.key);
    addMachine('Octo', server.url, '--kind', 'octoprint', '--api-key-file', key);
    await openSampleIn(page, 'Thermoform', 'Pyramid');
    await page.getByRole('button', { name: /^Accuracy/ }).click();
    await page.getByRole('textbox', { name: 'Triangles' }).fill('1000');
    await page.getByRole('textbox', { name: 'Triangles' }).press('Enter');
    await expect(strip(page, 'Preview up to date')).toBeVisible();
    await page.getByRole('button', { name: 'Form at full detail' }).click();
    await expect(strip(page, 'Sheet formed')).toBeVisible({ timeout: 150_000 });
    await page.getByRole('button', { name: 'Export something else' }).click();
    await page.getByRole('menuitem', { name: 'Send the mould to a 3D printer' }).click();
    const dialog = page.getByRole('dialog');
    await dialog.getByRole('button', { name: 'Slice' }).click({ timeout: 120_000 });
    await expect(dialog.getByText(/of filament/)).toBeVisible({ timeout: 120_000 });
    const waiting = page.waitForEvent('download');
    await dialog.getByRole('button', { name: 'Save the G-code' }).click();
    const gcode = readFileSync(await (await waiting).path(), 'utf8');
    expect(gcode).toContain('G1 ');
    const request = (path: string) =>
      fetch(`${server.url}${path}`, { headers: { 'X-Api-Key': server.key } }).then(
        (answer) => answer.json() as Promise<Record<string, unknown>>,
      );
    await dialog.getByRole('button', { name: 'Send', exact: true }).click();
    await expect(dialog.getByText(/is at Octo: start it there/)).toBeVisible({ timeout: 60_000 });
    const { files } = (await request('/api/files/local')) as { files: { name: string; size: number }[] };
    expect(files[0]?.size).toBe(Buffer.byteLength(gcode));
    expect(((await request('/api/job')) as { state: string }).state).toBe('Operational');
    await dialog.getByRole('button', { name: 'Send and start' }).click();
    await expect(dialog.getByText(/Is its bed clear/)).toBeVisible();
    await dialog.getByRole('button', { name: 'Send and start' }).click();
    await expect(dialog.getByText(/Octo is printing/)).toBeVisible({ timeout: 60_000 });
    await expect
      .poll(async () => ((await request('/api/job')) as { state: string }).state)
      .toMatch(/Printing|Starting/);
    await page.keyboard.press('Escape');
    await goToRoom(page, 'Machines');
    await page.getByRole('button', { name: 'Stop the print' }).click({ timeout: 30_000 });
    await expect
      .poll(async () => ((await request('/api/job')) as { state: string }).state, { timeout: 60_000 })
      .toMatch(/Operational|Cancelling/);
  } finally {
    removeMachine('Octo');
    await peer.end();
  }
});
