// SPDX-License-Identifier: GPL-3.0-or-later
// Several models on free-standing pillars, each seen from its own viewpoint.
import type { Page } from '@playwright/test';
import { readFileSync } from 'node:fs';
import { ballObj, expect, expectAccessible, fileOf, goToRoom, openPage, strip, test } from './page';

const plan = (page: Page) => page.getByRole('group', { name: 'Floor plan from above' });
const pillar = (page: Page, number: number) =>
  plan(page)
    .getByRole('button', { name: new RegExp(`^Pillar ${number}, `) })
    .and(page.locator('.pillar'));
const eye = (page: Page, number: number) =>
  plan(page).getByRole('button', { name: new RegExp(`^Viewpoint ${number}, .* eye at `) });
const field = (page: Page, name: string) => page.getByRole('textbox', { name, exact: true });
/** What the plan shows in colours, as it is drawn. */
const colours = (page: Page) => page.locator('.surfaces').innerHTML();
const upToDate = (page: Page) =>
  expect(strip(page, /^(Plan up to date|Forest ready)$/)).toBeVisible({ timeout: 120_000 });

async function openForest(page: Page): Promise<void> {
  await openPage(page);
  await goToRoom(page, 'Relief');
  await page.getByRole('button', { name: 'Pillar forest', exact: true }).click();
  await expect(page.locator('.surfaces polyline').first()).toBeVisible({ timeout: 120_000 });
}

async function set(page: Page, name: string, value: string): Promise<void> {
  await field(page, name).fill(value);
  await field(page, name).press('Enter');
}

/** Coarse, so that it is made in seconds. */
async function makeQuick(page: Page): Promise<void> {
  await page.getByRole('button', { name: /^Advanced/ }).click();
  await set(page, 'Vertices of the samples', '1500');
  await set(page, 'Detail of the solids', '1.2');
  await set(page, 'Rays of the check', '60');
  await set(page, 'Width of the pictures', '200');
}

test('four models on one forest: moved, made, looked at and kept', async ({ page }) => {
  test.setTimeout(420_000);
  await openForest(page);
  await expect(page.getByRole('heading', { name: '23 pillars' })).toBeVisible();
  for (const model of ['Bust', 'Octopus', 'Cat', 'Fish'])
    await expect(
      page.getByRole('button', { name: new RegExp(`^Viewpoint \\d, ${model} \\d+\\s% on pillars`) }),
    ).toBeVisible();
  await makeQuick(page);
  await upToDate(page);

  // By keys: a millimetre each, with Shift ten.
  const place = async () =>
    /at (\S+), (\S+) mm/
      .exec((await pillar(page, 3).getAttribute('aria-label')) ?? '')
      ?.slice(1)
      .join();
  const [before, at] = [await colours(page), await place()];
  await pillar(page, 3).focus();
  await page.keyboard.press('Shift+ArrowUp');
  await page.keyboard.press('ArrowUp');
  await expect.poll(place).not.toBe(at);
  await expect.poll(() => colours(page), { timeout: 60_000 }).not.toBe(before);
  await expect(field(page, 'Pillar x')).toBeVisible();
  await upToDate(page);

  // By the pointer, the colours following while it is held.
  const moved = await colours(page);
  const box = await pillar(page, 4).boundingBox();
  if (box === null) throw new Error('the pillar has no place');
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 15, y + 12, { steps: 4 });
  await expect.poll(() => colours(page), { timeout: 60_000 }).not.toBe(moved);
  await page.mouse.up();
  await upToDate(page);

  // Beside the plan, what an eye sees of it: whatever moves in the plan moves there, too.
  const seen = page.getByRole('img', { name: /^Bust and the pillars, seen from viewpoint 1$/ });
  await expect(seen).toBeVisible();
  await expect(seen.locator('image')).toHaveAttribute('href', /^blob:/);
  const drawn = await seen.innerHTML();
  await page.getByRole('button', { name: 'Seen from viewpoint 3' }).click();
  await expect(page.getByRole('img', { name: /^Cat and the pillars, seen from viewpoint 3$/ })).toBeVisible();
  await eye(page, 1).focus();
  await expect(seen).toBeVisible();
  await page.keyboard.press('Shift+ArrowLeft');
  await expect.poll(() => seen.innerHTML(), { timeout: 60_000 }).not.toBe(drawn);
  await page.getByRole('button', { name: 'Show what an eye sees' }).click();
  await expect(seen).toBeHidden();
  await page.getByRole('button', { name: 'Show what an eye sees' }).click();
  await expect(seen).toBeVisible();
  await upToDate(page);
  await expectAccessible(page, 'the floor plan of a forest');

  await page.getByRole('button', { name: 'Make the forest' }).click();
  await expect(strip(page, 'Forest ready')).toBeVisible({ timeout: 240_000 });
  const row = page.getByRole('row', { name: /Octopus/ });
  await expect(row.getByRole('cell').first()).toHaveText(/^\d+(\.\d)?\s%$/);
  await expect(row.getByRole('cell').nth(3)).toHaveText(/^0\s%$/); // nothing of other models
  await expect(page.getByRole('img', { name: 'From viewpoint 3: Cat' })).toBeVisible();
  await expect(page.getByRole('img', { name: 'From elsewhere' })).toBeVisible();
  await expectAccessible(page, 'the pictures of a forest');

  await page.getByRole('radio', { name: 'In space' }).click();
  await page.getByRole('button', { name: 'From viewpoint 2' }).click();
  await expect(page.getByRole('button', { name: 'From viewpoint 2' })).toHaveAttribute(
    'aria-pressed',
    'true',
  );
  await page.getByRole('button', { name: 'From elsewhere' }).click();

  const saved = page.waitForEvent('download');
  await page.getByRole('button', { name: 'Export Pillars, STL' }).click();
  const file = await saved;
  expect(file.suggestedFilename()).toBe('Pillar forest-pillars.zip');
  const zip = readFileSync(await file.path());
  for (const name of ['pillar_01.stl', 'pillar_23.stl']) expect(zip.includes(name)).toBe(true);

  // A reload finds it as it was left; undo goes on from there as from anywhere.
  await expect(page.getByText('Saved', { exact: true })).toBeVisible();
  await page.reload();
  await expect(strip(page, 'Forest ready')).toBeVisible({ timeout: 120_000 });
  await page.getByRole('radio', { name: 'From the eyes' }).click();
  await expect(row).toBeVisible();
  await page.getByRole('radio', { name: 'Floor plan' }).click();
  await expect.poll(place).not.toBe(at);

  // What the core refuses it says in words, and what was made stays.
  await pillar(page, 1).focus();
  await set(page, 'Pillar x', '11.4');
  await set(page, 'Pillar y', '-115.6');
  await expect(page.getByText(/^Pillars 1 and 4 (overlap|stand)/).first()).toBeVisible({ timeout: 60_000 });
  await expect(page.getByRole('button', { name: /^23 pillars, at least/ })).toBeVisible();
  await page.getByRole('button', { name: /^23 pillars, at least/ }).click();
  await expect(strip(page, 'Forest ready')).toBeVisible();
});

test('viewpoints and pillars are added, changed in numbers and taken away', async ({ page }) => {
  test.setTimeout(240_000);
  await openForest(page);
  await page.getByRole('button', { name: 'Add a pillar' }).click();
  await expect(page.getByRole('heading', { name: '24 pillars' })).toBeVisible();
  await page.getByRole('combobox', { name: 'Shape', exact: true }).first().selectOption('Hexagonal');
  await set(page, 'Width of the pillar', '20');
  await expect(pillar(page, 24)).toHaveAccessibleName(/hexagonal/);
  // An outline of its own: corners are moved, added and taken away.
  await page.getByRole('combobox', { name: 'Shape', exact: true }).first().selectOption('Own outline');
  await expect(pillar(page, 24)).toHaveAccessibleName(/own outline/);
  const corner = (number: number) =>
    plan(page).getByRole('button', { name: new RegExp(`^Pillar 24, corner ${number}, `) });
  const where = await corner(2).getAttribute('aria-label');
  await corner(2).focus();
  await page.keyboard.press('Shift+ArrowUp');
  await expect(corner(2)).not.toHaveAccessibleName(where ?? '');
  await plan(page).getByRole('button', { name: 'Pillar 24, add a corner between 2 and 3' }).press('Enter');
  await expect(corner(7)).toBeVisible();
  await corner(7).press('Delete');
  await expect(corner(7)).toHaveCount(0);
  await page.getByRole('button', { name: 'Delete pillar 24' }).click();
  await expect(page.getByRole('heading', { name: '23 pillars' })).toBeVisible();

  await page.getByRole('button', { name: 'Add a viewpoint' }).click();
  await expect(eye(page, 5)).toBeVisible();
  await page.getByRole('combobox', { name: 'Model', exact: true }).selectOption('Star');
  await expect(eye(page, 5)).toHaveAccessibleName(/Star/);
  await page.getByRole('button', { name: 'Delete viewpoint 5' }).click();
  await expect(eye(page, 5)).toBeHidden();
  await upToDate(page);

  // A model of one's own takes the place of the chosen viewpoint's.
  await eye(page, 2).click();
  await page.getByLabel('Model or project file').setInputFiles(fileOf('ball.obj', ballObj()));
  await expect(eye(page, 2)).toHaveAccessibleName(/^Viewpoint 2, ball, /);
  await expect(page.getByRole('button', { name: /^Viewpoint 2, ball \d+\s% on pillars/ })).toBeVisible();
  await upToDate(page);
  // A file that is no model is refused, and the one before stays.
  await page.getByLabel('Model or project file').setInputFiles(fileOf('notes.obj', 'milk, eggs'));
  await expect(page.getByText('Could not open notes.obj')).toBeVisible();
  await page.getByRole('button', { name: 'Hide this note' }).click();
  await expect(eye(page, 2)).toHaveAccessibleName(/^Viewpoint 2, ball, /);
  // A file that is no scene is refused by the core, and what is open stays.
  await page.getByLabel('Scene file').setInputFiles(fileOf('garden.json', '{"trees": 3}'));
  await expect(page.getByText('“trees”').or(page.getByText('"trees"')).first()).toBeVisible();
  await page.getByRole('button', { name: 'Hide this note' }).click();
  await expect(eye(page, 2)).toHaveAccessibleName(/ball/);

  // Another layout makes other pillars, and is set by hand from there.
  await page.getByRole('combobox', { name: 'Pillars', exact: true }).selectOption('Grid');
  await expect(page.getByRole('heading', { name: '36 pillars' })).toBeVisible({ timeout: 60_000 });
  await upToDate(page);
  await pillar(page, 1).focus();
  await page.keyboard.press('ArrowLeft');
  await expect(page.getByRole('combobox', { name: 'Pillars', exact: true })).toHaveValue('scene');
  await expect(page.getByRole('heading', { name: '36 pillars' })).toBeVisible();
  await page.getByRole('button', { name: 'Undo', exact: false }).first().click();
  await expect(page.getByRole('combobox', { name: 'Pillars', exact: true })).toHaveValue('grid');

  // The next project begins with its own model, not with the forest; the one before is found as it was left.
  await page.goto('/#/start');
  await page.locator('.gallery button', { hasText: 'Bust' }).click();
  await expect(page.getByRole('button', { name: 'Solve at full detail' })).toBeVisible({ timeout: 60_000 });
  await expect(plan(page)).toBeHidden();
  await page.getByRole('button', { name: 'Bust', exact: true }).click(); // the project's menu
  await page
    .getByRole('menuitemradio', { name: /^Pillar forest/ })
    .or(page.getByRole('menuitem', { name: /^Pillar forest/ }))
    .click();
  await expect(page.getByRole('heading', { name: '36 pillars' })).toBeVisible({ timeout: 60_000 });
});

test('on a phone a pillar is dragged and the list lies below', async ({ page }) => {
  await page.setViewportSize({ width: 390, height: 844 });
  await openForest(page);
  const bar = await page.getByRole('radio', { name: 'Eyes' }).boundingBox();
  expect((bar?.x ?? 0) + (bar?.width ?? 999)).toBeLessThanOrEqual(390);
  const before = await pillar(page, 9).getAttribute('aria-label');
  const box = await pillar(page, 9).boundingBox();
  if (box === null) throw new Error('the pillar has no place');
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2 + 20, { steps: 3 });
  await page.mouse.up();
  await expect(pillar(page, 9)).not.toHaveAttribute('aria-label', before ?? '');
  const seen = page.getByRole('img', { name: /^Bust and the pillars, seen from viewpoint 1$/ });
  await expect(seen).toBeHidden();
  await page.getByRole('button', { name: 'Show what an eye sees' }).click();
  const [left, right] = [await plan(page).boundingBox(), await seen.boundingBox()];
  expect((left?.x ?? 0) + (left?.width ?? 999)).toBeLessThanOrEqual(right?.x ?? 0);
  await page.getByRole('button', { name: 'Show what an eye sees' }).click();
  await page.getByRole('button', { name: 'Make this panel taller' }).click();
  await expect(page.getByRole('region', { name: 'Pillar 9' })).toBeVisible();
});
