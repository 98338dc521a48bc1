// SPDX-License-Identifier: GPL-3.0-or-later
// npm --prefix web run machines_page: makes docs/img/machines_page.png anew, the practice laser in the middle of a job. Needs the
// built page, the native build and the system's Chromium.
/* global console */
import { chromium } from '@playwright/test';
import { execFileSync, execSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { preview } from 'vite';

const web = resolve(import.meta.dirname, '..');
const program = resolve(web, '../build/formwright');
const picture = resolve(web, '../docs/img/machines_page.png');
const port = 5651;

const folder = mkdtempSync(join(tmpdir(), 'formwright-picture-'));
const design = [
  'zippable-design',
  '--sample',
  'star',
  '--size-mm',
  '110',
  '--width-mm',
  '15',
  '--out',
  folder,
  '--quiet',
];
execFileSync(program, design);
const bed = ['--bed-x-mm', '280', '--bed-y-mm', '180'];
execFileSync(program, [
  'zippable-plan',
  '--design',
  join(folder, 'design.json'),
  ...bed,
  '--out',
  folder,
  '--quiet',
]);

const server = await preview({ root: web, preview: { port, strictPort: true, host: '127.0.0.1' } });
const browser = await chromium.launch({
  executablePath: execSync('command -v chromium || command -v google-chrome', { encoding: 'utf8' }).trim(),
  args: ['--headless=new', '--no-sandbox'],
});
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  await page.goto(`http://127.0.0.1:${port}/`);
  await page.getByRole('link', { name: 'Machines', exact: true }).click();
  await page.getByLabel('Model or project file').setInputFiles(join(folder, 'plan.svg'));
  await page.getByRole('contentinfo').getByText('Job ready').first().waitFor();
  await page.getByRole('button', { name: 'Practise without a machine' }).click();
  await page.locator('.machine-buttons').getByRole('button', { name: 'Home' }).click();
  await page.getByRole('dialog').getByRole('button', { name: 'Home', exact: true }).click();
  await page.locator('.state-chip').getByText('Ready').waitFor();
  await page
    .locator('.inspector-foot')
    .getByRole('button', { name: /^Start/ })
    .click();
  await page.getByRole('dialog').getByRole('button', { name: 'Start with the laser on' }).click();
  await page.locator('.state-chip').getByText('Working').waitFor();
  await page.waitForTimeout(20_000);
  await page.screenshot({ path: picture });
  console.log(picture);
} finally {
  await browser.close();
  await server.close();
  rmSync(folder, { recursive: true });
}
