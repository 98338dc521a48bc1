// SPDX-License-Identifier: GPL-3.0-or-later
// A project made of samples is shared as a link; one with a model of one's own as a file.
import type { Page } from '@playwright/test';
import {
  backend,
  ballObj,
  expect,
  expectAccessible,
  expectAccessibleNow,
  fileOf,
  inEveryLook,
  openModel,
  openPage,
  openSample,
  strip,
  test,
} from './page';

const projects = (page: Page, name: string) =>
  page.locator('header').getByRole('button', { name, exact: true });
const thickness = (page: Page) => page.getByRole('textbox', { name: 'Thickness' }).first();
const copy = (page: Page) => page.getByRole('menuitem', { name: 'Copy a link' });

test('a link is copied from the keyboard and opened in a second page, beside what that page had', async ({
  page,
  context,
}) => {
  test.skip(backend === 'native', 'a second page has no token');
  await context.grantPermissions(['clipboard-read', 'clipboard-write']);
  await openSample(page);
  await thickness(page).fill('7');
  await thickness(page).press('Enter');
  await projects(page, 'Torus').press('ArrowDown');
  await page.keyboard.press('c');
  await expect(copy(page)).toBeFocused();
  await page.keyboard.press('Enter');
  await expect(page.getByRole('status').getByText('Link copied.')).toBeVisible();
  const link = await page.evaluate(() => navigator.clipboard.readText());
  expect(link).toContain('#/open?v=1&name=Torus&relief=torus&');
  expect(link).toContain('relief.thickness_mm=7');

  const second = await context.newPage();
  await second.goto(link);
  await expect(strip(second, 'Preview up to date')).toBeVisible();
  await expect(thickness(second)).toHaveValue('7.0');
  expect(new URL(second.url()).hash).toBe('#/relief'); // a reload does not open it once more
  await expect(page.getByRole('main', { name: 'Relief' })).toBeVisible();
  await thickness(second).fill('9');
  await thickness(second).press('Enter');

  // Damaged links leave the open project as it is and say why.
  for (const [wrong, sentence] of [
    ['#/open?v=1&relief=lion', 'asks for the sample “lion”'],
    ['#/open?v=1&relief=torus&relief.thickness_mm=-1', 'it takes a number from'],
    ['#/open?v=1&relief=torus&relief.__proto__=1', 'which this version does not have'],
    ['#/open', 'This link is damaged'],
  ] as const) {
    await second.evaluate((hash) => (location.hash = hash), wrong);
    await expect(second.getByRole('alert').getByText(sentence)).toBeVisible();
    expect(new URL(second.url()).hash).toBe('#/relief');
    await expect(thickness(second)).toHaveValue('9.0');
  }
  // Opened while another project is open: that one is saved and in the list.
  await second.evaluate((hash) => (location.hash = hash), new URL(link).hash);
  await expect(thickness(second)).toHaveValue('7.0');
  await projects(second, 'Torus').click();
  await expect(second.getByRole('menuitemradio', { name: 'Torus' })).toHaveCount(3);
});

test('a project with a model of one’s own says why there is no link, and is saved as a file', async ({
  page,
}) => {
  await openPage(page);
  await openModel(page, fileOf('ball.obj', ballObj()));
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await projects(page, 'ball').click();
  await expect(copy(page)).toContainText('for samples only');
  await copy(page).click();
  const dialog = page.getByRole('dialog', { name: 'No link to this project' });
  await expect(dialog).toContainText('ball.obj is a file of your own');
  const saving = page.waitForEvent('download');
  await dialog.getByRole('button', { name: 'Save as a file' }).click();
  expect((await saving).suggestedFilename()).toBe('ball.formwright');
});

test('the menu with the link, and the link where there is no clipboard', async ({ page }) => {
  test.skip(backend === 'native', 'the worker serves the same page');
  await page.addInitScript(() => Object.defineProperty(navigator, 'clipboard', { value: undefined }));
  await openSample(page);
  await inEveryLook(page, async (look) => {
    await projects(page, 'Torus').click(); // menus close when the window changes
    await expect(copy(page)).toBeVisible();
    await expectAccessibleNow(page, `the menu, ${look}`);
    await page.keyboard.press('Escape');
  });
  await projects(page, 'Torus').click();
  await copy(page).click();
  await expect(page.getByRole('textbox', { name: 'Link' })).toHaveValue(/#\/open\?v=1&name=Torus/);
  await expectAccessible(page, 'the dialog');
});
