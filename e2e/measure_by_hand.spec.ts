// SPDX-License-Identifier: GPL-3.0-or-later
// Without a scanner: a few marks, chosen by the simulation, measured with calipers and typed in.
import type { Page } from '@playwright/test';
import { readFileSync } from 'node:fs';
import { backend, expect, expectAccessible, goToRoom, openPage, strip, test } from './page';

test.skip(backend === 'mock', 'the mock makes reliefs only');
test.setTimeout(400_000);

const marks = 7;
const field = (page: Page, mark: number, axis: string) => page.getByLabel(`Mark ${mark}, ${axis} in mm`);

async function choose(page: Page, triangles: number): Promise<void> {
  await openPage(page);
  await goToRoom(page, 'Evidence');
  await page.getByRole('button', { name: 'Measure with calipers' }).click();
  await expect(page.getByLabel('Mould')).toHaveValue(/pyramid/);
  await page.getByRole('textbox', { name: 'Marks', exact: true }).fill(String(marks));
  await page.getByRole('textbox', { name: 'Marks', exact: true }).press('Enter');
  await page.getByRole('searchbox', { name: 'Find a setting' }).fill('Triangles');
  await page.getByRole('textbox', { name: 'Triangles' }).fill(String(triangles));
  await page.getByRole('textbox', { name: 'Triangles' }).press('Enter');
  await page.getByRole('button', { name: 'Choose the marks' }).click();
}

/** Where mark `i` is expected, as the table has it. */
async function expectedOf(page: Page, mark: number): Promise<string[]> {
  const text = await page
    .locator('.hand-numbers tbody tr')
    .nth(mark - 1)
    .locator('td')
    .nth(1)
    .textContent();
  return (text ?? '').replaceAll('\u2212', '-').split(', ');
}

async function measure(page: Page, mark: number): Promise<void> {
  const [x = '', y = '', z = ''] = await expectedOf(page, mark);
  await field(page, mark, 'x').fill(x);
  await field(page, mark, 'y').fill(y.replace('.', ','));
  await field(page, mark, 'z').fill(z);
}

test('marks are chosen, drawn, typed in, kept and compared', async ({ page }) => {
  await choose(page, 500); // a coarse sheet: what is chosen is not the question here
  await expect(strip(page, 'Marks chosen')).toBeVisible({ timeout: 300_000 });
  const shows = page.getByRole('row', { name: /: shows at usual strength/ });
  await expect(shows.filter({ hasText: 'Sheet slips in the clamp' })).toBeVisible();
  const rows = page.getByRole('row', { name: /: (shows at usual strength|hardly shows)/ });
  const said = `${await shows.count()} of ${await rows.count()} causes would show at their usual strength`;
  await expect(page.getByText(said)).toBeVisible();
  const picture = page.getByRole('img', {
    name: `${marks} numbered marks on the flat sheet, 0 of them measured`,
  });
  await expect(picture).toBeVisible();
  const waiting = page.waitForEvent('download');
  await page.getByRole('button', { name: 'Drawing at true size' }).click();
  const drawing = await waiting;
  expect(drawing.suggestedFilename()).toBe('Pyramid-marks.svg');
  expect(readFileSync(await drawing.path(), 'utf8').match(/<text/g)).toHaveLength(marks + 1);
  await expectAccessible(page, 'chosen');

  // What is no number, incomplete or far off is said at once.
  const use = page.getByRole('button', { name: 'Use these measurements' });
  await field(page, 1, 'x').fill('8o');
  await expect(page.getByText('“8o” is not a length in millimetres.')).toBeVisible();
  await field(page, 1, 'x').fill('80');
  await expect(page.getByText('Measure x, y and z, or leave the mark out.')).toBeVisible();
  await field(page, 1, 'y').fill('900');
  await field(page, 1, 'z').fill('3');
  await expect(page.getByText(/mm from where it is expected: read it once more\.$/)).toBeVisible();
  await expect(use).toHaveAttribute('aria-disabled', 'true');
  for (let mark = 1; mark <= 6; ++mark) await measure(page, mark);
  await expect(page.getByText('from where it is expected')).toBeHidden();
  const rim = (side: string) => page.getByLabel(`Thickness of the rim, ${side}, in mm`);
  await rim('left').fill('10');
  await expect(page.getByText('The sheet should be about 1 mm thick: read it once more.')).toBeVisible();
  await expect(use).toHaveAttribute('aria-disabled', 'true');
  await rim('left').fill('0,85');
  await rim('right').fill('1.15');
  await expect(use).not.toHaveAttribute('aria-disabled', 'true');

  // The same places, counted from the middle; undo; a reload.
  const before = await field(page, 1, 'x').inputValue();
  await page.getByRole('radio', { name: 'Middle' }).click();
  expect(Number(await field(page, 1, 'x').inputValue())).toBeCloseTo(Number(before) - 110, 3);
  await page.keyboard.press('Control+z');
  await expect(field(page, 1, 'x')).toHaveValue(before);
  await expect(page.getByText('Saved', { exact: true })).toBeVisible();
  await page.reload();
  await expect(field(page, 6, 'z')).not.toHaveValue('');
  await expect(rim('right')).toHaveValue('1.15');

  await use.click();
  await expect(strip(page, 'Compared with the settings as they are')).toBeVisible({ timeout: 120_000 });
  await expect(page.getByRole('button', { name: /^Pyramid 6 points, 2 thickness/ })).toBeVisible();
  await expect(page.getByText(/^0\.\d+\s?mm apart on average/)).toBeVisible();
});

test('a choice can be ended, and other settings ask for another one', async ({ page }) => {
  await choose(page, 10_000); // long enough to be ended on any computer
  await expect(page.getByRole('progressbar')).toBeVisible();
  await page.keyboard.press('Escape');
  await expect(strip(page, 'Measure by hand')).toBeVisible({ timeout: 5000 });
  await page.getByRole('button', { name: 'Leave' }).click();
  await expect(page.getByRole('button', { name: 'Measure with calipers' })).toBeVisible();
  await page.keyboard.press('Control+z');
  await expect(page.getByRole('button', { name: 'Choose the marks' })).toBeVisible();
});
