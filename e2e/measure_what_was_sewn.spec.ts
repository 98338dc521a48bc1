// SPDX-License-Identifier: GPL-3.0-or-later
// A sewn object is measured with a ruler; what was found changes the next plan.
import type { Page } from '@playwright/test';
import {
  backend,
  chooseSample,
  expect,
  expectAccessible,
  goToRoom,
  makeRibbon,
  openPage,
  test,
} from './page';

test.skip(backend === 'mock', 'the mock makes reliefs only');

const dialog = (page: Page) => page.getByRole('dialog', { name: 'Measure what you sewed' });

test('lengths of a sewn star: chosen, typed, diagnosed, made up for in the next plan', async ({ page }) => {
  test.slow();
  await openPage(page);
  await goToRoom(page, 'Zippable');
  await chooseSample(page, 'Star');
  for (const [name, value] of [
    ['Size', '150'],
    ['Ribbon width', '25'],
  ] as const) {
    await page.getByRole('textbox', { name, exact: true }).fill(value);
    await page.getByRole('textbox', { name, exact: true }).press('Enter');
  }
  await makeRibbon(page);

  await page.getByRole('button', { name: 'Measure what you sewed' }).click();
  await dialog(page).getByRole('button', { name: 'Choose the lengths' }).click();
  const fields = dialog(page).getByRole('textbox', { name: /^Measured from mark/ });
  await expect(fields).toHaveCount(20, { timeout: 120_000 });
  await expectAccessible(page, 'lengths of what was sewn');

  // Everything was cut 3 % too large; what is no length is said beside its field.
  const rows = dialog(page).locator('tbody tr');
  for (let i = 0; i < 20; ++i) {
    const expected = Number.parseFloat((await rows.nth(i).locator('td').nth(2).textContent()) ?? '');
    await fields.nth(i).fill((1.03 * expected).toFixed(1));
  }
  await fields.first().fill('about a hand');
  await expect(dialog(page).getByText('Type a length in millimetres, such as 143.5')).toBeVisible();
  await expect(dialog(page).getByRole('button', { name: 'Find out why' })).toHaveAttribute(
    'aria-disabled',
    'true',
  );
  const first = Number.parseFloat((await rows.first().locator('td').nth(2).textContent()) ?? '');
  await fields.first().fill((1.03 * first).toFixed(1));

  // What was typed is there after a reload.
  await page.keyboard.press('Escape');
  await expect(page.getByText('Saved', { exact: true })).toBeVisible();
  await page.reload();
  await page.getByRole('button', { name: 'Measure what you sewed' }).click();
  await expect(fields.first()).toHaveValue((1.03 * first).toFixed(1));
  await expect(dialog(page).getByText('20 of 20 measured')).toBeVisible();

  await dialog(page).getByRole('button', { name: 'Find out why' }).click();
  const found = dialog(page).getByRole('region', { name: 'What was found' });
  // Cut too large, and cloth that grew alike along and across, are the same to a ruler.
  await expect(found).toContainText(/The plan was cut about|the cloth became about/, { timeout: 300_000 });
  await expect(found).toContainText(/(2\.[89]|3(\.[0-2])?)\s%/);
  await found.getByRole('button', { name: 'Use in the next plan' }).click();
  await expect(found.getByRole('button', { name: 'Used in the next plan' })).toBeVisible();
  await page.keyboard.press('Escape');
  await page.getByRole('radio', { name: 'Sheets to cut' }).click();
  await expect(page.getByText(/The plan makes up for: /)).toBeAttached({ timeout: 60_000 });
});
