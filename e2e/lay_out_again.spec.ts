// SPDX-License-Identifier: GPL-3.0-or-later
// A cutting plan for a larger sheet than the laser's bed: one button lays it out again.
import { addLaser, button } from './machine_room';
import { backend, expect, goToRoom, makeRibbon, openSampleIn, strip, test } from './page';

test.skip(backend !== 'wasm', 'the page does the same with the worker');

test('a sheet that is larger than the bed is laid out again for it', async ({ page }) => {
  test.setTimeout(420_000);
  await openSampleIn(page, 'Zippable', 'Star');
  const size = page.getByRole('textbox', { name: 'Size', exact: true });
  await size.fill('700');
  await size.press('Enter');
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await makeRibbon(page);
  await page.getByRole('radio', { name: 'Sheets to cut' }).click();
  // Set by hand, a sheet may be too large for the machine.
  const width = page.getByRole('textbox', { name: 'Sheet width' });
  await width.fill('600');
  await width.press('Enter');
  await expect(page.getByRole('img', { name: / of 600 × 400\smm; / })).toBeVisible({ timeout: 150_000 });
  await page.getByRole('button', { name: /Send to a machine/ }).click();
  const first = page.getByRole('menuitem', { name: 'Sheet 1', exact: true });
  await first.click();

  await expect(page.getByRole('status').getByText('The sheet does not fit on the bed')).toBeVisible({
    timeout: 60_000,
  });
  await expect(page.getByText(/shrink/)).toHaveCount(0);
  await button(page, 'Lay out again for 400 × 400').click();
  await expect(page.getByRole('img', { name: / of 400 × 400\smm; / })).toBeVisible({ timeout: 150_000 });
  await page.getByRole('button', { name: /Send to a machine/ }).click();
  await first.click();
  await expect(strip(page, 'Job ready')).toBeVisible({ timeout: 60_000 });
  await expect(page.getByText('does not fit')).toHaveCount(0);
});

test('the sheets follow the laser that is chosen, and stay in a project that is opened again', async ({
  page,
}) => {
  test.setTimeout(300_000);
  await openSampleIn(page, 'Zippable', 'Star');
  await makeRibbon(page);
  await page.getByRole('radio', { name: 'Sheets to cut' }).click();
  await expect(page.getByRole('img', { name: / of 400 × 400\smm; / })).toBeVisible({ timeout: 60_000 });

  // The sheets are as large as the chosen laser's bed, and the room says so.
  const sheets = page.getByRole('region', { name: 'Sheets', exact: true });
  await expect(sheets.getByRole('status')).toHaveText(/^Practice laser: 400 × 400\smm$/);
  // By hand, and back, by keyboard alone.
  await button(page, 'Use another size').focus();
  await page.keyboard.press('Enter');
  const width = page.getByRole('textbox', { name: 'Sheet width' });
  await expect(width).toHaveValue('400');
  await width.fill('600');
  await width.press('Enter');
  await expect(sheets.getByRole('status')).toHaveText(/^Set by hand: 600 × 400\smm$/);
  await sheets.getByRole('button', { name: /^Use Practice laser: 400 × 400/ }).focus();
  await page.keyboard.press('Enter');
  await expect(width).toHaveValue('');
  await expect(page.getByRole('img', { name: / of 400 × 400\smm; / })).toBeVisible({ timeout: 60_000 });
  await page.keyboard.press('Control+z');
  await expect(page.getByRole('img', { name: / of 600 × 400\smm; / })).toBeVisible({ timeout: 60_000 });
  await page.keyboard.press('Control+Shift+z');
  await expect(page.getByRole('img', { name: / of 400 × 400\smm; / })).toBeVisible();

  await addLaser(page, 'Workshop', '800', '500');
  await goToRoom(page, 'Zippable');
  await expect(page.getByRole('img', { name: / of 800 × 500\smm; / })).toBeVisible({ timeout: 60_000 });
  await expect(page.getByText('Saved', { exact: true })).toBeVisible();

  // Another laser is chosen while another project is open: this one stays as it was laid out.
  await page.locator('.project').click();
  await page.getByRole('menuitem', { name: 'New project' }).click();
  await addLaser(page, 'Small', '300', '200');
  await page.locator('.project').click();
  await page.getByRole('menuitemradio', { name: /^Star/ }).click();
  await goToRoom(page, 'Zippable');
  await page.getByRole('radio', { name: 'Sheets to cut' }).click();
  await expect(page.getByRole('img', { name: / of 800 × 500\smm; / })).toBeVisible();
  await expect(page.getByText(/^Workshop: 800 × 500\smm$/)).toBeVisible();
  await page.getByRole('button', { name: /^Use Small: 300 × 200/ }).click();
  await expect(page.getByRole('img', { name: / of 300 × 200\smm; / })).toBeVisible({ timeout: 60_000 });
});
