// SPDX-License-Identifier: GPL-3.0-or-later
// A relief of which a maker says by hand what stands out and what lies on the base.
import type { Page } from '@playwright/test';
import { backend, expect, expectAccessible, openSample, solve, strip, test } from './page';

test.skip(backend === 'mock', 'the mock does not read a painting');

const tool = (page: Page) => page.getByRole('group', { name: 'Paint the model' });
const paint = (page: Page, name: string) => tool(page).getByRole('radio', { name, exact: true });
const painted = (page: Page) => page.getByText(/^Painted: /);

/** The middle of the 3D view. */
async function middle(page: Page): Promise<{ x: number; y: number }> {
  const box = await page.locator('.viewport').boundingBox();
  if (box === null) throw new Error('there is no view');
  return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
}

/** "Watertight, 120.0 × 85.5 × 8.0 mm": the last length, mm. */
async function depthOfSolid(page: Page): Promise<number> {
  const line = await page.getByText(/^Watertight, /).textContent();
  return Number(/× ([\d.]+)\s*mm/.exec(line?.replace(/^.*×.*(?=×)/, '') ?? '')?.[1]);
}

test('what is painted stands out, is undone, and survives a reload', async ({ page }) => {
  test.setTimeout(420_000);
  await openSample(page, 'Bust');
  await solve(page);
  expect(await depthOfSolid(page)).toBeCloseTo(8, 5);

  await page.getByRole('button', { name: 'Paint the model', exact: true }).click();
  await paint(page, 'Free').check();
  const { x, y } = await middle(page);
  // The model is found under the pointer once its search tree is built, in a worker; the view keeps still before, too.
  await expect(async () => {
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x, y + 40, { steps: 8 });
    await page.mouse.up();
    await expect(painted(page)).toHaveText('Painted: Free.', { timeout: 3000 });
  }).toPass({ timeout: 60_000 });
  await expect(page.getByText('Turned away from the viewpoint')).toBeHidden();
  await expect(tool(page).getByRole('button', { name: 'Clear “Free”' })).toBeVisible();
  // The camera kept still, and the relief made before is no longer that of the painted model.
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await expectAccessible(page, 'a painted model');

  await page.keyboard.press('Control+z');
  await expect(painted(page)).toBeHidden();
  await expect(strip(page, 'Relief ready')).toBeVisible();
  await page.keyboard.press('Control+Shift+z');
  await expect(painted(page)).toHaveText('Painted: Free.');

  // Without pointing. A thickness of 10 mm everywhere is a relief of 10 mm.
  await paint(page, 'Own thickness').check();
  await tool(page).getByRole('button', { name: 'Fill' }).click();
  await page.getByRole('menuitem', { name: 'The whole model' }).click();
  await expect(painted(page)).toHaveText('Painted: Own thickness.');
  await tool(page).getByRole('button', { name: 'Done' }).click();
  await expect(tool(page)).toBeHidden();
  await expect(strip(page, 'Preview up to date')).toBeVisible();

  await expect(page.getByText('Saved', { exact: true })).toBeVisible();
  await page.reload();
  await expect(painted(page)).toHaveText('Painted: Own thickness.');
  await solve(page);
  expect(await depthOfSolid(page)).toBeCloseTo(13, 5);

  // The relief of before comes back with what was painted then: nothing.
  const results = page.getByRole('list', { name: 'Earlier results' }).getByRole('button');
  await expect(results).toHaveCount(2);
  await results.nth(1).click();
  await expect(painted(page)).toBeHidden();
  await expect(strip(page, 'Relief ready')).toBeVisible();
  expect(await depthOfSolid(page)).toBeCloseTo(8, 5);
  await results.nth(0).click();
  await expect(painted(page)).toHaveText('Painted: Own thickness.');
  await expect(strip(page, 'Relief ready')).toBeVisible();
});

test.describe('with a finger on a narrow screen', () => {
  test.use({ hasTouch: true, viewport: { width: 390, height: 844 } });
  test('a tap paints', async ({ page }) => {
    await openSample(page, 'Bust');
    await page.getByRole('button', { name: 'Paint the model', exact: true }).click();
    await paint(page, 'Matters more').check();
    await tool(page).getByRole('button', { name: 'Dab in the middle' }).click();
    await expect(painted(page)).toHaveText('Painted: Matters more.');
    await expectAccessible(page, 'a painted model on a narrow screen');
  });
});
