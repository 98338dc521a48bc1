// SPDX-License-Identifier: GPL-3.0-or-later
// A relief seen in the light in which it will hang, before it is made.
import type { Page } from '@playwright/test';
import { readFileSync } from 'node:fs';
import { expect, expectAccessible, openSample, test } from './page';

const view = (page: Page, name: string) => page.getByRole('radio', { name, exact: true });
const field = (page: Page, name: string) => page.getByRole('textbox', { name, exact: true });
const likeness = (page: Page) => page.getByText(/^Likeness to the model \d\.\d\d, \d+\s%/);
const hours = (page: Page) => page.getByRole('img', { name: /looks most like the model at/ });

async function savedBy(page: Page, name: string): Promise<{ name: string; bytes: Buffer }> {
  const saved = page.waitForEvent('download', { timeout: 120_000 });
  await page.getByRole('button', { name, exact: true }).click();
  const file = await saved;
  return { name: file.suggestedFilename(), bytes: readFileSync(await file.path()) };
}

test('the sun of a day, a sky and a lamp fall on the relief', async ({ page }) => {
  test.setTimeout(420_000);
  await openSample(page);
  await view(page, 'In real light').click();
  await expect(likeness(page)).toBeVisible({ timeout: 120_000 });
  await expect(hours(page)).toBeVisible();

  // Another hour, by its field, by the curve and by the best one.
  const atNoon = await likeness(page).textContent();
  await field(page, 'Hour').fill('10');
  await field(page, 'Hour').press('Enter');
  await expect(likeness(page)).not.toHaveText(atNoon ?? '');
  const box = await hours(page).boundingBox();
  if (box === null) throw new Error('the curve has no place');
  await page.mouse.click(box.x + (15 / 24) * box.width, box.y + box.height / 3);
  await expect(field(page, 'Hour')).toHaveValue(/^15/);
  const best = page.getByRole('button', { name: /^Best in the sun: / });
  const clock = /(\d+):(\d\d)/.exec((await best.textContent()) ?? '') ?? [];
  await best.click();
  await expect(field(page, 'Hour')).toHaveValue(
    new RegExp(`^${Number(clock[1]) + Number(clock[2]) / 60}(\\.0+)?$`),
  );
  // At night it is said, and nothing fails.
  await field(page, 'Hour').fill('1');
  await field(page, 'Hour').press('Enter');
  await expect(page.getByText('The sun is below the horizon, so there is no daylight.')).toBeVisible();
  await page.getByRole('button', { name: /^Best hour: / }).click();
  await expect(likeness(page)).toBeVisible();
  await expectAccessible(page, 'a relief in real light');

  await page.getByLabel('Date', { exact: true }).fill('2026-12-21');
  await expect(hours(page)).toHaveAccessibleName(/Daylight from (8|9):/);

  // Other lights have no hours.
  await page.getByRole('combobox', { name: 'Light', exact: true }).selectOption('Overcast sky');
  await expect(hours(page)).toBeHidden();
  await expect(field(page, 'Latitude')).toBeHidden();
  await page.getByRole('combobox', { name: 'Light', exact: true }).selectOption('Strobe');
  await expect(field(page, 'Distance of the light')).toBeVisible();
  await expect(likeness(page)).toBeVisible({ timeout: 120_000 });

  // A change of the relief is lit anew; what is there stays until then.
  const before = await likeness(page).textContent();
  await field(page, 'Thickness').fill('12');
  await field(page, 'Thickness').press('Enter');
  await expect(likeness(page)).not.toHaveText(before ?? '', { timeout: 120_000 });

  const picture = await savedBy(page, 'Picture');
  expect(picture.name).toBe('Torus-light.png');
  expect(picture.bytes.subarray(1, 4).toString()).toBe('PNG');
  const lithophane = await savedBy(page, 'Lithophane');
  expect(lithophane.bytes[24]).toBe(16); // bits a level
  const walk = await savedBy(page, 'Walking past');
  expect(walk.bytes.subarray(0, 2).toString()).toBe('PK');
  expect(walk.bytes.includes('13_front.png')).toBe(true);

  // By keys to another view and back; the light is kept with the project.
  await view(page, 'In real light').focus();
  await page.keyboard.press('ArrowLeft');
  await expect(view(page, 'Shading difference')).toBeChecked();
  await expect(page.getByRole('combobox', { name: 'Light', exact: true })).toBeHidden();
  await page.keyboard.press('ArrowRight');
  await expect(page.getByRole('combobox', { name: 'Light', exact: true })).toHaveValue('strobe');
});

test('on a phone the views fit beside each other', async ({ page }) => {
  await page.setViewportSize({ width: 390, height: 844 });
  await openSample(page);
  const last = view(page, 'Light');
  await last.click();
  const box = await last.boundingBox();
  expect((box?.x ?? 0) + (box?.width ?? 999)).toBeLessThanOrEqual(390);
  await page.getByRole('button', { name: 'Make this panel taller' }).click();
  await expect(likeness(page)).toBeVisible({ timeout: 120_000 });
  await expect(hours(page)).toBeVisible();
});
