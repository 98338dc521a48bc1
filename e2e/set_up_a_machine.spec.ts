// SPDX-License-Identifier: GPL-3.0-or-later
// Before a job runs: profiles, materials, files, what does not fit, two tabs.
import type { Page } from '@playwright/test';
import { readFileSync } from 'node:fs';
import {
  square,
  chip,
  button,
  startButton,
  dialog,
  openRoom,
  openDrawing,
  confirm,
  practise,
  homeIt,
  makeReady,
  startIt,
} from './machine_room';
import { backend, expect, expectAccessible, fileOf, strip, test } from './page';

test.skip(
  backend !== 'wasm',
  'the mock makes reliefs only; the worker’s own machines: machines_of_the_worker.spec.ts',
);

test('what a tab controls no other tab does', async ({ page, context }) => {
  await openRoom(page);
  await practise(page);
  const second = await context.newPage();
  await openRoom(second);
  await button(second, 'Practise without a machine').click();
  await expect(
    second.getByRole('alert').getByText(/^Another tab of this page controls a machine/),
  ).toBeVisible();
  await button(page, 'Disconnect').click();
  await expect(chip(page)).toHaveText('Offline');
  await button(second, 'Practise without a machine').click();
  await expect(chip(second)).toHaveText('Locked');
  await second.close();
});

test('wrong files are said in words and the work stays', async ({ page }) => {
  await openDrawing(page);
  const input = page.getByLabel('Model or project file');
  await input.setInputFiles(fileOf('words.txt', 'hello'));
  await expect(page.getByRole('alert').getByText('Could not open words.txt')).toBeVisible();
  await expect(page.getByRole('alert').getByText(/^Machines take drawings \(\.svg\), jobs/)).toBeVisible();
  await expect(strip(page, 'Job ready')).toBeVisible();
  await input.setInputFiles(fileOf('notes.svg', 'this is no drawing'));
  await expect(page.getByRole('alert').getByText('Could not read notes.svg')).toBeVisible();
  await input.setInputFiles(fileOf('notes.nc', 'no moves in here'));
  await expect(page.getByRole('alert').getByText('Could not read notes.nc')).toBeVisible();
  await input.setInputFiles(fileOf('line.nc', 'G21 G90\nM4 S500\nG1 X50 Y0 F3000\nG1 X50 Y20\nM5\n'));
  await expect(page.getByRole('img', { name: /job from 0\.0+, 0\.0+ to 50\.0+, 20\.0+\smm/ })).toBeVisible();
});

test('a job that does not fit is said before anything moves', async ({ page }) => {
  await openDrawing(page);
  await page.getByRole('textbox', { name: 'Position in x' }).fill('390');
  await page.getByRole('textbox', { name: 'Position in x' }).press('Enter');
  await expect(strip(page, 'The job does not fit')).toBeVisible();
  await practise(page);
  await homeIt(page);
  const start = startButton(page);
  await expect(start).toHaveAttribute('aria-disabled', 'true');
  await start.click({ force: true });
  await expect(dialog(page)).toBeHidden();
});

test('a profile goes out as a file and comes back', async ({ page }) => {
  await openRoom(page);
  const menu = page.locator('.profile-button');
  await menu.click();
  await page.getByRole('menuitem', { name: 'Add a machine' }).click();
  await dialog(page).getByLabel('Name').fill('Workshop laser');
  await dialog(page).getByLabel('Bed width, mm').fill('600');
  await dialog(page).getByRole('button', { name: 'Add', exact: true }).click();
  await expect(menu).toHaveText('Workshop laser');
  await menu.click();
  const waiting = page.waitForEvent('download');
  await page.getByRole('menuitem', { name: 'Export its profile' }).click();
  const path = await (await waiting).path();
  const text = readFileSync(path, 'utf8');
  expect(JSON.parse(text)).toMatchObject({ name: 'Workshop laser', parameters: { bed_x_mm: 600 } });
  await menu.click();
  await page.getByRole('menuitem', { name: 'Remove this machine' }).click();
  await expect(menu).toHaveText('Practice laser');
  const file = page.getByLabel('Machine profile');
  await file.setInputFiles(fileOf('broken.json', '{"format":"formwright-machine","version":1}'));
  await expect(page.getByRole('alert').getByText('Could not read broken.json')).toBeVisible();
  await file.setInputFiles(fileOf('workshop.json', text));
  await expect(menu).toHaveText('Workshop laser');
  await expect(page.getByRole('img', { name: /bed/i })).toBeVisible();
  await page.reload();
  await expect(menu).toHaveText('Workshop laser');
});

const showsTest = (page: Page) => page.getByRole('region', { name: 'What the test shows' });

test('material is tested, and what the tests show is set and kept', async ({ page }) => {
  test.setTimeout(420_000); // a small test is run to its end
  await openDrawing(page);
  await button(page, 'Save as a material').click();
  await dialog(page).getByLabel('Name').fill('Felt');
  await dialog(page).getByRole('button', { name: 'Save', exact: true }).click();
  await expect(page.getByLabel('Preset').locator('option:checked')).toHaveText('Felt');

  // Four squares, quick, run like any job.
  await button(page, 'Test material').click();
  await expect(page.getByRole('combobox', { name: 'Best square' }).locator('option')).toHaveCount(26);
  for (const [name, value] of [
    ['Number of powers', '2'],
    ['Number of speeds', '2'],
    ['Lowest speed', '50'],
    ['Highest speed', '100'],
  ] as const) {
    await page.getByRole('textbox', { name, exact: true }).fill(value);
    await page.getByRole('textbox', { name, exact: true }).press('Enter');
  }
  await expect(page.getByRole('combobox', { name: 'Best square' }).locator('option')).toHaveCount(5);
  await expect(strip(page, 'Job ready')).toBeVisible();
  await makeReady(page);
  await button(page, 'Frame').click();
  await confirm(page, /^Frame the job/, 'Frame', /laser stays off/);
  await expect(chip(page)).toHaveText('Moving');
  await expect(chip(page)).toHaveText('Ready', { timeout: 60_000 });
  await startIt(page);
  await expect(strip(page, 'Material test is done')).toBeVisible({ timeout: 240_000 });

  // A click on a square chooses it, and so do the keys.
  const bed = page.getByRole('img', { name: /^Bed of 400 × 400/ });
  const box = await bed.boundingBox();
  if (box === null) throw new Error('No bed.');
  const scale = Math.min((box.width - 62) / 400, (box.height - 44) / 400);
  const left = box.x + 44 + (box.width - 62 - 400 * scale) / 2;
  const low = box.y + box.height - 30 - (box.height - 44 - 400 * scale) / 2;
  const best = page.getByRole('combobox', { name: 'Best square' });
  await best.selectOption('R1C1');
  const [x, y] = [32, 14]; // about the first square's middle; its place is said in the report
  await page.mouse.click(left + x * scale, low - y * scale);
  await expect(best).toHaveValue('R1C1');
  await best.focus();
  await page.keyboard.press('ArrowDown');
  await expect(best).toHaveValue('R1C2');
  await showsTest(page).getByRole('button', { name: 'Use for cutting' }).click();
  await expect(page.getByText('100 % at 50.0 mm/s is set for cutting, and saved with Felt.')).toBeVisible();
  await expect(page.getByLabel('Preset').locator('option:checked')).toHaveText('Felt');
  await expect(page.getByRole('region', { name: 'Layers, in order' })).toContainText(
    /Cut, 1 part100\s%, 50\.0\smm\/s/,
  );
});

test('what the kerf’s scale says becomes the kerf', async ({ page }) => {
  await openDrawing(page);
  await button(page, 'Test material').click();
  await page.getByRole('combobox', { name: 'Test', exact: true }).selectOption('kerf');
  await page.getByRole('textbox', { name: 'Kerf read from the scale' }).fill('0.2');
  await page.getByRole('textbox', { name: 'Kerf read from the scale' }).press('Enter');
  await button(page, 'Use as the kerf').click();
  await expect(strip(page, 'Job ready')).toBeVisible();
  await page.getByRole('button', { name: /^Cutting 1 of \d+ changed$/ }).click();
  await expect(page.getByRole('textbox', { name: 'Kerf', exact: true })).toHaveValue(/^0\.20+$/);
});

test('axe finds nothing serious in the room', { tag: '@screens' }, async ({ page }) => {
  test.skip(backend === 'native', 'the worker serves the same page');
  await openRoom(page);
  await expectAccessible(page, 'empty');
  await page.getByLabel('Model or project file').setInputFiles(square);
  await expect(strip(page, 'Job ready')).toBeVisible();
  await expectAccessible(page, 'drawing');
  await practise(page);
  await expectAccessible(page, 'locked');
  await page.locator('.machine-buttons').getByRole('button', { name: 'Home' }).click();
  await expectAccessible(page, 'question');
  await dialog(page).getByRole('button', { name: 'Home', exact: true }).click();
  await expect(chip(page)).toHaveText('Ready');
  await expectAccessible(page, 'ready', 'machine');
  await page.getByRole('radio', { name: '3D' }).click();
  await expectAccessible(page, 'in space');
  await page.getByRole('radio', { name: 'Console' }).click();
  await expectAccessible(page, 'console');
  await page.getByRole('radio', { name: 'Bed' }).click();
  await button(page, 'Test material').click();
  await expect(showsTest(page)).toBeVisible();
  await expectAccessible(page, 'test');
});
