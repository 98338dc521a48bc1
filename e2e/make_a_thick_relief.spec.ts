// SPDX-License-Identifier: GPL-3.0-or-later
// A relief as a thick surface on its plate, up to the file that is exported.
import { readFileSync } from 'node:fs';
import { backend, expect, expectAccessible, openSample, readStl, solve, strip, test } from './page';

test.skip(backend === 'mock', 'the mock makes filled solids only');

test('a thick surface is exported closed, and keeps to what is painted', async ({ page }) => {
  test.setTimeout(420_000);
  await openSample(page, 'Octopus');
  const field = (name: string) => page.getByRole('textbox', { name, exact: true });
  const set = async (name: string, value: string) => {
    await field(name).fill(value);
    await field(name).press('Enter');
  };
  await set('Width', '50');
  await expect(field('Wall thickness')).toBeHidden();
  await page.getByRole('radio', { name: 'Thick surface', exact: true }).check();
  await expect(field('Wall thickness')).toHaveValue(/^2/);
  await set('Wall thickness', '1');
  await expectAccessible(page, 'a thick surface');

  // Another base is refused, with the reason, until it is flat again.
  await page.getByRole('combobox', { name: 'Shape of the base' }).selectOption('Waves');
  const reason = page.getByRole('region', { name: 'Output', exact: true }).getByRole('alert');
  await expect(reason).toContainText('A thick surface is joined to a flat base only');
  await page.getByRole('combobox', { name: 'Shape of the base' }).selectOption('Flat');
  await expect(strip(page, 'Preview up to date')).toBeVisible();

  // Painted limits of depth count for the solid, too.
  await page.getByRole('button', { name: 'Paint the model', exact: true }).click();
  const tool = page.getByRole('group', { name: 'Paint the model' });
  await tool.getByRole('radio', { name: 'Own thickness', exact: true }).check();
  await tool.getByRole('button', { name: 'Fill' }).click();
  await page.getByRole('menuitem', { name: 'The whole model' }).click();
  await tool.getByRole('button', { name: 'Done' }).click();
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await solve(page);
  await expect(page.getByText(/^Watertight, 50\.0 × .* × 13\.0/)).toBeVisible();
  const waiting = page.waitForEvent('download');
  await page.getByRole('button', { name: 'Export STL' }).click();
  const solid = readStl(readFileSync(await (await waiting).path()));
  expect(solid.closed).toBe(true);
  expect(solid.size[0]).toBeCloseTo(50, 2);
  expect(solid.size[2]).toBeCloseTo(13, 1);
});
