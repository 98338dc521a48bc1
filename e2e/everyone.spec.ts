// SPDX-License-Identifier: GPL-3.0-or-later
// Keyboard alone, and axe on every page in both themes at both widths.
import type { Page } from '@playwright/test';
import { backend, expect, expectAccessible, openPage, openSample, solve, strip, test } from './page';

/** Tabs until the wanted element has the focus; a person would not go on for ever. */
async function tabTo(page: Page, selector: string): Promise<void> {
  for (let i = 0; i < 80; ++i) {
    await page.keyboard.press('Tab');
    if (await page.evaluate((wanted) => document.activeElement?.matches(wanted) === true, selector)) return;
  }
  throw new Error(`${selector} was not reached by Tab.`);
}

test('with the keyboard alone', async ({ page }) => {
  await openPage(page);
  await tabTo(page, '.gallery button');
  await page.keyboard.press('Enter');
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await tabTo(page, 'input[type=range][aria-label=Thickness]');
  await page.keyboard.press('Shift+ArrowRight');
  await expect(page.getByRole('textbox', { name: 'Thickness' })).not.toHaveValue('5.0');
  await page.keyboard.press('Control+z');
  await expect(page.getByRole('textbox', { name: 'Thickness' })).toHaveValue('5.0');
  await page.keyboard.press('?');
  await expect(page.getByRole('dialog', { name: 'All keys' })).toBeVisible();
  await page.keyboard.press('Escape');
  await expect(page.getByRole('dialog')).toBeHidden();
  await page.keyboard.press('Control+Enter');
  await expect(strip(page, 'Relief ready')).toBeVisible({ timeout: 150_000 });
  const waiting = page.waitForEvent('download');
  await page.keyboard.press('Control+e');
  expect((await waiting).suggestedFilename()).toMatch(/\.stl$/);
  await page.keyboard.press('2');
  await expect(page.getByText('A shell starts from a model.')).toBeVisible();
  await page.keyboard.press('3');
  await expect(page.getByText('A zippable starts from a closed model.')).toBeVisible();
  await page.keyboard.press('5');
  await expect(page.getByRole('button', { name: 'Practise without a machine' })).toBeVisible();
});

test('axe finds nothing serious', { tag: '@screens' }, async ({ page }) => {
  test.skip(backend === 'native', 'the worker serves the same page');
  await openPage(page);
  await expectAccessible(page, 'start', 'start');
  await openSample(page);
  await expectAccessible(page, 'preview');
  await page.getByRole('button', { name: /^Advanced/ }).click();
  await expectAccessible(page, 'advanced');
  await solve(page);
  await expectAccessible(page, 'solved', 'relief');
  await page.goto('/#/about');
  await expect(page.getByRole('heading', { name: 'About Formwright' })).toBeVisible();
  await expectAccessible(page, 'about');
  await page.goto('/#/machines');
  await expect(page.getByRole('button', { name: 'Practise without a machine' })).toBeVisible();
  await expectAccessible(page, 'machines');
});
