// SPDX-License-Identifier: GPL-3.0-or-later
// A cutting plan for a larger sheet than the laser's bed: one button lays it out again.
import { button } from './machine_room';
import { backend, expect, openPage, strip, test } from './page';

test.skip(backend !== 'wasm', 'the page does the same with the worker');

test('a sheet that is larger than the bed is laid out again for it', async ({ page }) => {
  test.setTimeout(150_000);
  await openPage(page);
  await page.getByRole('link', { name: 'Zippable', exact: true }).click();
  await page.locator('.gallery button', { hasText: 'Star' }).click();
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  const size = page.getByRole('textbox', { name: 'Size', exact: true });
  await size.fill('700');
  await size.press('Enter');
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await page.getByRole('button', { name: 'Make the ribbon', exact: true }).click();
  await expect(strip(page, 'Ribbon unfolded')).toBeVisible({ timeout: 150_000 });
  await page.getByRole('radio', { name: 'Sheets to cut' }).click();
  await expect(page.getByRole('img', { name: / of 600 × 300\smm; / })).toBeVisible({ timeout: 60_000 });
  await page.getByRole('button', { name: /Send to a machine/ }).click();
  const first = page.getByRole('menuitem', { name: 'Sheet 1', exact: true });
  await first.click();

  await expect(page.getByRole('status').getByText('The sheet does not fit on the bed')).toBeVisible({
    timeout: 60_000,
  });
  await expect(page.getByText(/shrink/)).toHaveCount(0);
  await button(page, 'Lay out again for 400 × 400').click();
  await expect(page.getByRole('img', { name: / of 400 × 400\smm; / })).toBeVisible({ timeout: 60_000 });
  await page.getByRole('button', { name: /Send to a machine/ }).click();
  await first.click();
  await expect(strip(page, 'Job ready')).toBeVisible({ timeout: 60_000 });
  await expect(page.getByText('does not fit')).toHaveCount(0);
});
