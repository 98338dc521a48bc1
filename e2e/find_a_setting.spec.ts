// SPDX-License-Identifier: GPL-3.0-or-later
// A setting is found by words, whether its group is folded or not; what was changed is listed and reset.
import type { Page } from '@playwright/test';
import { backend, expect, expectAccessible, openSampleIn, test } from './page';

test.skip(backend !== 'wasm', 'the mock makes reliefs only; the worker serves the same page');

const field = (page: Page) => page.getByRole('searchbox', { name: 'Find a setting' });
const found = (page: Page) => page.getByRole('search', { name: 'Settings' }).getByRole('status');

test('a setting is found by its name from the keyboard, changed, listed and reset', async ({ page }) => {
  await openSampleIn(page, 'Thermoform', 'Pyramid');
  const strain = page.getByRole('textbox', { name: 'Yield strain', exact: true });
  await expect(strain).toBeHidden();
  await page.keyboard.press('p');
  await expect(field(page)).toBeFocused();
  await page.keyboard.type('yield_strain');
  await expect(strain).toBeVisible();
  await expect(page.getByRole('region', { name: 'Material' })).toBeVisible();
  await expect(found(page)).toHaveText(/^\d+ settings? found\.$/);
  await strain.fill('0.15');
  await strain.press('Enter');
  await field(page).fill('no such thing');
  await expect(found(page)).toContainText('No setting has “no such thing”');
  await page.keyboard.press('Escape');
  await expect(field(page)).toHaveValue('');
  await expect(strain).toBeHidden();
  await expect(page.getByRole('button', { name: /^Material 1 of \d+ changed/ })).toBeVisible();
  await page.getByRole('button', { name: 'Only changed settings, 1' }).click();
  await expect(strain).toHaveValue('0.150');
  await page.getByRole('button', { name: /^Restore Yield strain to/ }).press('Enter');
  await expect(strain).toBeFocused();
  await expect(strain).toHaveValue('0.100');
  await expect(found(page)).toHaveText('All settings have their default values.');
  await page.getByRole('button', { name: 'Only changed settings, 0' }).click();
  await expect(page.getByRole('button', { name: /^Material \d+$/ })).toBeVisible();
});

test('every room with many settings has the search, and the list of keys names it', async ({ page }) => {
  await openSampleIn(page, 'Thermoform', 'Pyramid');
  for (const [room, setting] of [
    ['Relief', 'Thickness'],
    ['Zippable', 'Seam allowance'],
  ] as const) {
    await page.getByRole('link', { name: room, exact: true }).click();
    await page.getByRole('button', { name: 'Use Pyramid' }).click();
    await field(page).fill(setting);
    await expect(page.getByRole('textbox', { name: setting }).first()).toBeVisible();
  }
  await field(page).fill('');
  await field(page).blur();
  await page.keyboard.press('?');
  await expect(page.getByRole('dialog').getByText('Find a setting')).toBeVisible();
});

test('what a search for a setting finds', async ({ page }) => {
  await openSampleIn(page, 'Thermoform', 'Pyramid');
  await field(page).fill('mm');
  await expect(found(page)).toContainText('settings found');
  await expectAccessible(page, 'found');
  await field(page).fill('zebra');
  await expectAccessible(page, 'nothing found');
});
