// SPDX-License-Identifier: GPL-3.0-or-later
// From a formed sheet to paper: with the worker to a real IPP printer (ippeveprinter), without one to a PDF.
import type { Page } from '@playwright/test';
import { execFileSync } from 'node:child_process';
import { readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { backend, expect, expectAccessible, goToRoom, openPage, openSampleIn, strip, test } from './page';
import { addMachine, askWorker, isInstalled, Peer, removeMachine } from './worker_peers';

test.skip(backend === 'mock', 'the mock makes reliefs only');

const dialog = (page: Page) => page.getByRole('dialog');
const choose = async (page: Page, name: RegExp | string) => {
  await page.getByRole('button', { name: 'Export something else' }).click();
  const item = page.getByRole('menuitem', { name });
  await expect(item).toBeEnabled(); // not while another file is being made
  await item.click();
};

async function openPicture(page: Page, sample: string): Promise<void> {
  await openSampleIn(page, 'Thermoform', sample);
  await page.getByRole('button', { name: /^Accuracy/ }).click();
  await page.getByRole('textbox', { name: 'Triangles' }).fill('1500');
  await page.getByRole('textbox', { name: 'Triangles' }).press('Enter');
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await page.getByRole('button', { name: 'Form at full detail' }).click();
  await expect(strip(page, 'Sheet formed')).toBeVisible({ timeout: 150_000 });
}

async function openDialog(page: Page): Promise<void> {
  await choose(page, 'Print the picture on paper');
  await expect(dialog(page).getByRole('heading', { name: /^Print the picture of/ })).toBeVisible({
    timeout: 120_000,
  });
  await expect(dialog(page).getByRole('img', { name: /the picture of .* on \d by \d pages/ })).toBeVisible({
    timeout: 120_000,
  });
}

interface Media {
  readonly name: string;
  readonly label: string;
  readonly loaded: boolean;
  readonly margins_mm: Readonly<Record<'left' | 'right' | 'top' | 'bottom', number>>;
}

test('from the sample mountain to a printed picture', async ({ page }) => {
  test.skip(backend !== 'native', 'a page alone reaches no printer');
  test.skip(!isInstalled('ippeveprinter'), 'ippeveprinter is not installed');
  test.setTimeout(420_000);
  const peer = new Peer();
  try {
    const printer = await peer.startProgram<{ url: string; spool: string }>('printer', 5639);
    const id = addMachine('Studio', printer.url);
    await openPicture(page, 'Mountain');

    // The picture itself, to compare with.
    const waiting = page.waitForEvent('download', { timeout: 120_000 });
    await choose(page, 'Print as one picture (PNG)');
    const picture = join(peer.folder, 'picture.png');
    writeFileSync(picture, readFileSync(await (await waiting).path()));

    await openDialog(page);
    await dialog(page).getByRole('combobox', { name: 'Printer' }).selectOption({ label: 'Studio' });
    await expect(dialog(page).getByRole('combobox', { name: 'Paper', exact: true })).toBeVisible();
    await dialog(page).getByRole('combobox', { name: 'Paper', exact: true }).selectOption('iso_a4_210x297mm'); // fed by hand
    await dialog(page).getByRole('textbox', { name: 'Copies' }).fill('2');
    await dialog(page).getByRole('textbox', { name: 'Copies' }).press('Enter');
    await expect(dialog(page).getByRole('status')).toContainText('true size');
    await expectAccessible(page, 'print dialog');
    await dialog(page).getByRole('button', { name: 'Print', exact: true }).click();
    await expect(dialog(page).getByRole('status')).toContainText(
      /Studio has printed the picture of Mountain/,
      {
        timeout: 120_000,
      },
    );

    const spooled = readdirSync(printer.spool).filter((name) => name.endsWith('.document'));
    expect(spooled).toHaveLength(1);
    const job = join(printer.spool, spooled[0] ?? '');
    const attributes = readFileSync(job.replace(/document$/, 'done'), 'utf8');
    expect(attributes).toContain('IPP_COPIES=2');
    expect(attributes).toContain('IPP_PRINT_SCALING=none');
    expect(attributes).toMatch(/x-dimension=21000/);
    const { media } = await askWorker<{ media: Media[] }>(`machines/${id}`);
    const a4 = media.find(({ name }) => name === 'iso_a4_210x297mm');
    const read = resolve(import.meta.dirname, 'printed_picture.py');
    const output = execFileSync('/usr/bin/python3', [read, job, picture, JSON.stringify(a4?.margins_mm)], {
      encoding: 'utf8',
    });
    const result = JSON.parse(output) as { sheet_mm: number[]; off_mean: number; shifted_mm: number };
    expect(Math.min(...result.sheet_mm)).toBeCloseTo(210, 0);
    expect(Math.max(...result.sheet_mm)).toBeCloseTo(297, 0);
    expect(result.off_mean).toBeLessThan(3); // of 255 grey levels
    expect(result.shifted_mm).toBeLessThan(0.3);
  } finally {
    removeMachine('Studio');
    await peer.end();
  }
});

test('without a printer: pages for the paper that is chosen, as a PDF', async ({ page }) => {
  await openPicture(page, 'Hemisphere');
  await openDialog(page);
  await dialog(page)
    .getByRole('combobox', { name: 'Printer' })
    .selectOption({ label: 'No printer: save a PDF' });
  await dialog(page).getByRole('combobox', { name: 'Paper', exact: true }).selectOption({ label: 'A2' });
  await expect(dialog(page).getByRole('img', { name: /on one page$/ })).toBeVisible({ timeout: 60_000 });
  const waiting = page.waitForEvent('download');
  await dialog(page).getByRole('button', { name: 'Save the PDF' }).click();
  const download = await waiting;
  expect(download.suggestedFilename()).toBe('the picture of Hemisphere.pdf');
  const info = execFileSync('pdfinfo', [await download.path()], { encoding: 'utf8' });
  expect(info).toMatch(/Pages: +1\n/);
  expect(info).toMatch(/Page size: +1683\.\d+ x 1190\.\d+|Page size: +1190\.\d+ x 1683\.\d+/);
  // A wrong value is said at its field, and the pages stay.
  await dialog(page).getByRole('textbox', { name: 'Overlap' }).fill('99');
  await dialog(page).getByRole('textbox', { name: 'Overlap' }).press('Enter');
  await dialog(page).getByRole('combobox', { name: 'Paper', exact: true }).selectOption({ label: 'A4' });
  await expect(dialog(page).getByRole('img', { name: /on \d by \d pages$/ })).toBeVisible({
    timeout: 60_000,
  });
  await page.keyboard.press('Escape');
  await expect(dialog(page)).toBeHidden();
});

test('the print dialog', { tag: '@screens' }, async ({ page }) => {
  test.skip(backend === 'native', 'the worker serves the same page');
  await openPage(page);
  await goToRoom(page, 'Evidence');
  await page.getByRole('button', { name: 'Print a pattern' }).click();
  await expectAccessible(page, 'pattern dialog');
  const waiting = page.waitForEvent('download', { timeout: 120_000 });
  await dialog(page).getByRole('button', { name: 'Save pattern.json and print' }).click();
  expect((await waiting).suggestedFilename()).toBe('pattern.json');
  await expect(dialog(page).getByRole('img', { name: /^the pattern on/ })).toBeVisible({ timeout: 120_000 });
  await expectAccessible(page, 'print dialog', 'print_dialog');
});
