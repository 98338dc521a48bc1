// SPDX-License-Identifier: GPL-3.0-or-later
import { backend, chooseSample, expect, fileOf, openPage, openSample, solve, strip, test } from './page';

test('a reload keeps model, settings and results', async ({ page }) => {
  await openSample(page);
  const thickness = page.getByRole('textbox', { name: 'Thickness' });
  await thickness.fill('6.5');
  await thickness.press('Enter');
  await solve(page);
  await expect(page.getByText('Saved', { exact: true })).toBeVisible();
  await page.reload();
  await expect(strip(page, 'Relief ready')).toBeVisible();
  await expect(thickness).toHaveValue('6.5');
  await expect(page.getByRole('list', { name: 'Earlier results' }).getByRole('button')).toHaveCount(1);
});

test('a wrong file is said in words and the work stays', async ({ page }) => {
  await openSample(page);
  const model = await page.locator('.model-row strong').textContent();
  await page.getByLabel('Model or project file').setInputFiles(fileOf('notes.obj', 'this is no model'));
  await expect(page.getByRole('alert').getByText('Could not open notes.obj')).toBeVisible();
  await expect(page.locator('.model-row strong')).toHaveText(model ?? '');
  await expect(page.getByRole('button', { name: 'Choose another file' })).toBeVisible();
  await page.getByRole('button', { name: 'Hide this note' }).click();
  await expect(page.getByText('Could not open notes.obj')).toBeHidden();
});

test('a value out of range marks its field and keeps the last good one', async ({ page }) => {
  await openSample(page);
  const thickness = page.getByRole('textbox', { name: 'Thickness' });
  await thickness.fill('5000');
  await thickness.press('Enter');
  await expect(thickness).toHaveAttribute('aria-invalid', 'true');
  await expect(page.getByRole('alert').filter({ hasText: /to 1000/ })).toBeVisible();
  await expect(page.getByRole('slider', { name: 'Thickness' })).toHaveAttribute('aria-valuetext', /^5\.0/);
  await thickness.press('Escape');
  await expect(thickness).toHaveValue('5.0');
});

test('two tabs keep out of each other’s way', async ({ page, context }) => {
  await openSample(page);
  await expect(page.getByText('Saved', { exact: true })).toBeVisible();
  const other = await context.newPage();
  await openPage(other);
  await expect(other.getByText(/is open in another tab; here is a new project/)).toBeVisible();
  await chooseSample(other, 'Star');
  await expect(other.getByText('Saved', { exact: true })).toBeVisible();
  // What the first tab deletes is its own: the other’s model, which it has never seen, stays.
  await page.locator('.project').click();
  await page.getByRole('menuitem', { name: 'Delete' }).click();
  await page.getByRole('dialog').getByRole('button', { name: 'Delete' }).click();
  await expect(page.getByRole('dialog')).toBeHidden();
  await other.reload();
  await expect(strip(other, 'Preview up to date')).toBeVisible();
  await expect(other.locator('.model-row strong')).toHaveText(/Star/);
  await other.close();
});

test('a project goes through a file', async ({ page }) => {
  await openSample(page);
  await page.locator('.project').click();
  const waiting = page.waitForEvent('download');
  await page.getByRole('menuitem', { name: 'Save as a file' }).click();
  const download = await waiting;
  expect(download.suggestedFilename()).toMatch(/\.formwright$/);
  const file = await download.path();
  await page.locator('.project').click();
  await page.getByRole('menuitem', { name: 'Delete' }).click();
  await page.getByRole('dialog').getByRole('button', { name: 'Delete' }).click();
  await openPage(page);
  await page.getByLabel('Model or project file').setInputFiles({
    name: 'a.formwright',
    mimeType: 'application/zip',
    buffer: (await import('node:fs')).readFileSync(file),
  });
  await expect(strip(page, 'Preview up to date')).toBeVisible();
});

test('without a network, once it has been here', async ({ page, context }) => {
  test.skip(backend !== 'wasm', 'the worker is on this machine and serves the page itself');
  await openPage(page);
  await page.evaluate(async () => void (await navigator.serviceWorker.ready));
  await context.setOffline(true);
  await page.reload();
  await openSample(page);
  expect(await page.evaluate(() => crossOriginIsolated)).toBe(true);
});
