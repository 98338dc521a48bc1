// SPDX-License-Identifier: GPL-3.0-or-later
// Several models in one relief: added, placed by hand and by keys, kept, and taken away again.
import type { Page } from '@playwright/test';
import { readFileSync } from 'node:fs';
import { ballObj, expect, expectAccessible, fileOf, openSampleIn, readStl, solve, strip, test } from './page';

const field = (page: Page, name: string) => page.getByRole('textbox', { name, exact: true });
const models = (page: Page) => page.getByRole('region', { name: 'Models', exact: true });
const previewed = (page: Page) => expect(strip(page, 'Preview up to date')).toBeVisible({ timeout: 120_000 });
const value = (page: Page, name: string) => field(page, name).inputValue();

async function add(page: Page, name: string): Promise<void> {
  await models(page)
    .getByRole('button', { name: /^Add (another|a) model$/ })
    .click();
  await page.getByRole('menuitem', { name, exact: true }).click();
}

test('several models become one relief', async ({ page }) => {
  test.setTimeout(300_000);
  await openSampleIn(page, 'Relief', 'Star');
  await previewed(page);
  await add(page, 'Heart');
  await expect(models(page).getByRole('heading', { name: '2 models' })).toBeVisible({ timeout: 60_000 });
  // What is added stands beside what is there, and all lie on the base with their outlines.
  expect(Number(await value(page, 'Place x'))).toBeGreaterThan(80);
  await expect(field(page, 'Height of the outline')).toHaveValue('0.1');
  await previewed(page);

  await page.getByRole('radio', { name: 'Original' }).click();
  const move = page.getByRole('button', { name: /^Move Heart\. / });
  const at = await value(page, 'Place x');
  await move.focus();
  await page.keyboard.press('ArrowLeft');
  await expect(field(page, 'Place x')).toHaveValue((Number(at) - 5).toFixed(1).replace('.0', ''));
  const box = await move.boundingBox();
  if (box === null) throw new Error('the handle has no place');
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x - 20, y - 30, { steps: 4 });
  await expect.poll(() => value(page, 'Place y')).not.toBe('0'); // while it is held
  await page.mouse.up();
  const turn = page.getByRole('button', { name: /^Turn Heart\. / });
  await turn.focus();
  await page.keyboard.press('ArrowRight');
  await expect(field(page, 'Turn y')).toHaveValue('15');
  await field(page, 'Longest side').fill('60');
  await field(page, 'Longest side').press('Enter');
  await previewed(page);
  await expectAccessible(page, 'several models in a relief');

  await solve(page);
  const saved = page.waitForEvent('download');
  await page.getByRole('button', { name: 'Export STL' }).click();
  const solid = readStl(readFileSync(await (await saved).path()));
  expect(solid.closed).toBe(true);

  // A reload keeps them; each step can be undone.
  await expect(page.getByText('Saved', { exact: true })).toBeVisible();
  await page.reload();
  await models(page).getByRole('button', { name: 'Heart', exact: true }).click();
  await expect(field(page, 'Longest side')).toHaveValue('60');
  await page.getByRole('button', { name: 'Remove Heart' }).click();
  await expect(models(page).getByRole('heading', { name: '1 model' })).toBeVisible({ timeout: 60_000 });
  await expect(page.getByRole('button', { name: 'A relief needs one model' })).toBeDisabled();
  await page.getByRole('button', { name: /^Undo/ }).click();
  await expect(models(page).getByRole('heading', { name: '2 models' })).toBeVisible();
});

test('files dropped together stand side by side; a file that is no model changes nothing', async ({
  page,
}) => {
  test.setTimeout(180_000);
  await openSampleIn(page, 'Relief', 'Star');
  await previewed(page);
  const input = page.getByLabel('File of another model');
  await input.setInputFiles(fileOf('broken.obj', 'this is no model'));
  await expect(page.getByText('Could not add broken')).toBeVisible({ timeout: 60_000 });
  await expect(models(page).getByRole('heading')).toHaveCount(0);
  await input.setInputFiles(fileOf('ball.obj', ballObj()));
  await expect(models(page).getByRole('heading', { name: '2 models' })).toBeVisible({ timeout: 60_000 });
  await page.getByRole('button', { name: 'Duplicate ball' }).click();
  await expect(models(page).getByRole('heading', { name: '3 models' })).toBeVisible({ timeout: 60_000 });
  await previewed(page);
});
