// SPDX-License-Identifier: GPL-3.0-or-later
// Which way up a model stands in the thermoforming room: laid on a side, placed on a face, turned and tilted.
import type { Locator, Page } from '@playwright/test';
import { backend, expect, expectAccessible, openSampleIn, strip, test } from './page';

test.skip(backend !== 'wasm', 'the mock makes reliefs only; the worker serves the same page');

const faces = (page: Page) => page.getByRole('listbox', { name: 'Faces, the largest first' });
const placeOnFace = (page: Page) => page.getByRole('button', { name: 'Place on face', exact: true });
const up = (page: Page) => Promise.all(['Up x', 'Up y', 'Up z'].map((name) => number(page, name)));
const number = async (page: Page, name: string) => {
  const text = await page.getByRole('textbox', { name, exact: true }).inputValue();
  return Number(text.replace('\u2212', '-'));
};

/** Handles move while notes come and the camera turns: they are taken where they have stood still. */
async function middleOf(handle: Locator): Promise<{ x: number; y: number }> {
  let box = await handle.boundingBox();
  for (let still = 0; still < 3;) {
    await handle.page().waitForTimeout(400);
    const before = box;
    box = await handle.boundingBox();
    still = before?.x === box?.x && before?.y === box?.y ? still + 1 : 0;
  }
  if (box === null) throw new Error('The handle is not to be seen.');
  return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
}

test('a model on its side, on a face, tilted and turned by keyboard alone, each one step to undo', async ({
  page,
}) => {
  await openSampleIn(page, 'Thermoform', 'Pyramid');
  await page.getByRole('button', { name: /^Advanced/ }).click();
  expect(await up(page)).toEqual([0, 1, 0]);
  await page.getByRole('button', { name: 'Left side' }).focus();
  await page.keyboard.press('Enter');
  expect(await up(page)).toEqual([1, 0, 0]);
  await expect(page.getByRole('button', { name: 'Stand as in the file' })).toBeEnabled();
  await page.keyboard.press('Control+z');
  expect(await up(page)).toEqual([0, 1, 0]);

  await placeOnFace(page).focus();
  await page.keyboard.press('Enter');
  await expect(faces(page)).toBeFocused();
  await expect(faces(page).getByRole('option')).toHaveCount(5); // the square below and four walls
  await expect(faces(page).getByRole('option').first()).toHaveText(/^Face 1, 100\scm² on the plate$/);
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('ArrowDown');
  await expect(faces(page).getByRole('option', { selected: true })).toHaveText(/^Face 2, 39\scm²$/);
  await page.keyboard.press('Escape'); // changes nothing
  await expect(faces(page)).toBeHidden();
  expect(await up(page)).toEqual([0, 1, 0]);
  await expect(placeOnFace(page)).toBeFocused();
  await page.keyboard.press('Enter');
  await expect(faces(page)).toBeFocused();
  await page.keyboard.press('End');
  await page.keyboard.press('Enter');
  await expect(faces(page)).toBeHidden();
  await page.keyboard.press('Enter');
  await expect(faces(page).getByRole('option').last()).toHaveText(/on the plate$/);
  await page.keyboard.press('Escape');
  await page.keyboard.press('Control+z');
  expect(await up(page)).toEqual([0, 1, 0]);

  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await page.getByRole('button', { name: /^Tilt the model sideways/ }).focus();
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('Shift+ArrowRight');
  // The top leans to the right by 16 degrees: the file's direction that points up leans to the left.
  expect(await up(page)).toEqual([-0.276, 0.961, 0]);
  await page.keyboard.press('Shift+ArrowLeft');
  await page.getByRole('button', { name: /^Turn the model/ }).focus();
  await page.keyboard.press('ArrowLeft');
  expect(await number(page, 'Turn')).toBe(-15);
  for (let i = 0; i < 2; ++i) await page.keyboard.press('Control+z');
  expect(await number(page, 'Turn')).toBe(0);
});

test('a face pressed on the model comes to lie on the plate; its handle turns it in steps of 15°', async ({
  page,
}) => {
  await openSampleIn(page, 'Thermoform', 'Pyramid');
  await page.getByRole('button', { name: /^Advanced/ }).click();
  await placeOnFace(page).click();
  const wall = page.locator('.face-overlay polygon.facing').first();
  await expect(wall).toBeVisible();
  await middleOf(wall);
  const at = await wall.evaluate((polygon) => {
    const points = [...(polygon as SVGPolygonElement).points];
    const box = (polygon as SVGPolygonElement).ownerSVGElement?.getBoundingClientRect();
    const mean = (of: number[]) => of.reduce((sum, x) => sum + x, 0) / of.length;
    return {
      x: (box?.left ?? 0) + mean(points.map(({ x }) => x)),
      y: (box?.top ?? 0) + mean(points.map(({ y }) => y)),
    };
  });
  await page.mouse.move(at.x, at.y);
  await expect(page.locator('.face-overlay polygon.pointed')).toHaveCount(1);
  await page.mouse.click(at.x, at.y);
  await expect(faces(page)).toBeHidden();
  expect(await up(page)).not.toEqual([0, 1, 0]);
  await expect(page.getByRole('textbox', { name: 'Size', exact: true })).toHaveValue(/^(|1\d\d(\.\d+)?)$/);
  await page.keyboard.press('Control+z');
  expect(await up(page)).toEqual([0, 1, 0]);
  await expect(strip(page, 'Preview up to date')).toBeVisible();

  const handle = page.getByRole('button', { name: /^Turn the model/ });
  const from = await middleOf(handle);
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(from.x + 30, from.y - 70, { steps: 5 });
  await page.mouse.up();
  const turn = await number(page, 'Turn');
  expect(turn).toBeGreaterThan(0);
  expect(turn % 15).toBe(0);
  await page.keyboard.press('Control+z');
  expect(await number(page, 'Turn')).toBe(0);
});

test('a model that all but touches the clamp is said, and made to keep 5 mm', async ({ page }) => {
  await openSampleIn(page, 'Thermoform', 'Pyramid');
  await page.getByRole('button', { name: /^Advanced/ }).click();
  const shift = page.getByRole('textbox', { name: 'Shift in x' });
  await shift.fill(String((await number(page, 'Opening width')) / 2 - 52)); // the pyramid is 100 mm wide
  await shift.press('Enter');
  await expect(page.getByText(/^The model comes within 2(\.0)?\smm of the clamp$/)).toBeVisible();
  await page.getByRole('button', { name: /more notes?$|^What to do$/ }).click();
  await page.getByRole('button', { name: 'Make it fit' }).click();
  expect(await number(page, 'Shift in x')).toBe(0);
  await expect(page.getByText(/of the clamp$/)).toBeHidden();
});

test('axe finds nothing serious while a face is chosen', async ({ page }) => {
  await openSampleIn(page, 'Thermoform', 'Pyramid');
  await placeOnFace(page).click();
  await expect(faces(page)).toBeVisible();
  await expectAccessible(page, 'place on face');
});
