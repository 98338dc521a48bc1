// SPDX-License-Identifier: GPL-3.0-or-later
import type { Page } from '@playwright/test';
import { readFileSync } from 'node:fs';
import {
  backend,
  chooseSample,
  expect,
  expectAccessible,
  fileOf,
  goToRoom,
  makeRibbon,
  openPage,
  strip,
  test,
} from './page';

test.skip(backend === 'mock', 'the mock makes reliefs only');

async function openRoom(page: Page): Promise<void> {
  await openPage(page);
  await goToRoom(page, 'Zippable');
  await expect(page.getByText('A zippable starts from a closed model.')).toBeVisible();
}

async function openSample(page: Page, title: string): Promise<void> {
  await openRoom(page);
  await chooseSample(page, title);
}

const seam = (page: Page) => page.locator('.flat-foot').getByText(/^Seam: /);
const alongZipper = (page: Page) => page.getByRole('slider', { name: 'Place along the zipper' });

/** Width and height in mm of an SVG that says them, and how many lines its zipper has. */
function readSvg(path: string): { size: number[]; segments: number } {
  const text = readFileSync(path, 'utf8');
  const size = [/width="([\d.]+)mm"/, /height="([\d.]+)mm"/].map((one) => Number(one.exec(text)?.[1]));
  const zipper = /<path id="zipper"[^>]* d="([^"]*)"/.exec(text)?.[1] ?? '';
  return { size, segments: zipper.split('L').length - 1 };
}

test('a star by mouse: windings, the same place on both sides, SVG, reload', async ({ page }) => {
  await openSample(page, 'Star');
  await expect(page.getByRole('list', { name: 'Parts' }).getByRole('button')).toHaveCount(5);
  const before = await seam(page).textContent();
  await page.getByRole('textbox', { name: 'Windings' }).fill('4');
  await page.getByRole('textbox', { name: 'Windings' }).press('Enter');
  await expect(seam(page)).not.toHaveText(before ?? '');
  await expect(strip(page, 'Preview up to date')).toBeVisible();

  // On the number that is written upon a part one is upon that part.
  const label = page.locator('.flat-label').first();
  await label.hover({ force: true });
  await expect(page.locator('.flat-ribbon .pointed')).toHaveCount(1);
  await expect(page.locator('.part-row.under')).toHaveCount(1);
  await expect(page.getByText(/m from the start$/)).toBeVisible();

  await page.getByRole('radio', { name: 'Distortion' }).click();
  await expect(page.getByRole('img', { name: /^Distortion: colours from 1/ })).toBeVisible();
  await page.getByRole('radio', { name: 'Zipped' }).click();
  await expect(
    page.getByText('Animation only: lengths are kept, but forces are not simulated.'),
  ).toBeVisible();

  await makeRibbon(page);
  const waiting = page.waitForEvent('download');
  await page.getByRole('button', { name: /^Export flat ribbon/ }).click();
  const download = await waiting;
  expect(download.suggestedFilename()).toBe('Star-ribbon.svg');
  const { size, segments } = readSvg(await download.path());
  for (const length of size) expect(length).toBeGreaterThan(50);
  expect(segments).toBeGreaterThan(100);

  // The same ribbon on the sheets that it is cut from.
  const made = await seam(page).textContent();
  await page.getByRole('radio', { name: 'Sheets to cut' }).click();
  const words = /^\d pieces on \d sheets? of 400 × 400\smm; zipper to cut: \d\.\d\d\sm$/;
  await expect(page.getByRole('img', { name: words })).toBeVisible();
  await page.getByRole('textbox', { name: 'Sheet width' }).fill('200');
  await page.getByRole('textbox', { name: 'Sheet width' }).press('Enter');
  await expect(page.getByRole('img', { name: / of 200 × 400\smm; / })).toBeVisible();
  await expect(strip(page, 'Ribbon unfolded')).toBeVisible(); // which does not depend on the bed
  const planned = page.waitForEvent('download');
  await page.getByRole('button', { name: 'Export plan, SVG' }).click();
  const plan = readFileSync(await (await planned).path(), 'utf8');
  expect(plan).toMatch(/<svg[^>]* height="400mm"/);
  for (const layer of ['cut', 'mark', 'engrave']) expect(plan).toContain(`id="${layer}"`);
  await page.getByRole('radio', { name: 'Ribbon', exact: true }).click();

  await expect(page.getByText('Saved', { exact: true })).toBeVisible();
  await page.reload();
  await expect(strip(page, 'Ribbon unfolded')).toBeVisible();
  await expect(seam(page)).toHaveText(made ?? '');
  await expect(page.getByRole('textbox', { name: 'Windings' })).toHaveValue('4.0');
});

test('cloth zipped up, frame by frame, and what became of it', async ({ page }) => {
  await openSample(page, 'Star');
  await makeRibbon(page);
  await page.getByRole('radio', { name: 'Zipped' }).click();
  await page.getByRole('button', { name: 'Will it zip? Simulate cloth' }).click();
  await expect(page.getByText(/^It zips (into|up)/)).toBeVisible({ timeout: 150_000 });
  await expect(page.getByRole('radio', { name: 'Simulated cloth' })).toBeChecked();
  await page.getByRole('slider', { name: 'From flat to zipped' }).fill('0.5');
  await page.getByRole('radio', { name: 'Geometry only' }).click();
  await expect(
    page.getByText('Animation only: lengths are kept, but forces are not simulated.'),
  ).toBeVisible();
});

test('a star by keyboard alone', async ({ page }) => {
  await openPage(page);
  await page.keyboard.press('3');
  const star = page.locator('.gallery button', { hasText: 'Star' });
  await expect(star).toBeVisible();
  await star.focus();
  await page.keyboard.press('Enter');
  await expect(strip(page, 'Preview up to date')).toBeVisible();

  await alongZipper(page).focus();
  await page.keyboard.press('Home');
  await expect(alongZipper(page)).toHaveAttribute('aria-valuetext', /^0\.00\sm from the start$/);
  await page.keyboard.press('Shift+ArrowRight');
  await page.keyboard.press('Shift+ArrowRight');
  await expect(alongZipper(page)).toHaveAttribute('aria-valuetext', /^0\.0[1-9]\sm from the start$/);
  await expect(page.locator('.flat-ribbon .pointed')).toHaveCount(2); // both sides of the seam

  const width = page.getByRole('textbox', { name: 'Ribbon width' });
  await width.focus();
  await page.keyboard.press('Control+a');
  await page.keyboard.type('15');
  await page.keyboard.press('Enter');
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await page.getByRole('slider', { name: 'Ribbon width' }).focus();
  await page.keyboard.press('Control+z');
  await expect(width).toHaveValue('20.0');
  await page.keyboard.press('Control+Shift+z');
  await expect(width).toHaveValue('15.0');

  await page.keyboard.press('Control+e'); // makes the ribbon first
  const download = await page.waitForEvent('download', { timeout: 150_000 });
  expect(download.suggestedFilename()).toBe('Star-ribbon.svg');
  expect(readSvg(await download.path()).segments).toBeGreaterThan(100);
});

test('what cannot be made is said in the core’s words, and undone', async ({ page }) => {
  await openSample(page, 'Star');
  const order = page.getByRole('textbox', { name: 'Order of parts' });
  await order.fill('99999');
  await order.press('Enter');
  await expect(page.getByRole('alert').first()).toBeVisible();
  await expect(strip(page, 'No ribbon')).toBeVisible();
  await page.getByRole('slider', { name: 'Order of parts' }).focus();
  await page.keyboard.press('Control+z');
  await expect(strip(page, 'Preview up to date')).toBeVisible();

  await page.getByLabel('Model or project file').setInputFiles(fileOf('notes.obj', 'this is no model'));
  await expect(page.getByRole('alert').getByText('Could not open notes.obj')).toBeVisible();
  await expect(page.locator('.model-row strong')).toHaveText('Star');
});

test('parts drawn by hand: a border and a cut with the mouse, an opening moved with the keyboard', async ({
  page,
}) => {
  await openSample(page, 'Heart');
  const parts = page.getByRole('list', { name: 'Parts' }).getByRole('button');
  await expect(parts).toHaveCount(3);
  await page.getByRole('button', { name: 'Draw the parts' }).click();
  const pane = page.locator('.zippable-model');
  const box = await pane.boundingBox();
  if (box === null) throw new Error('The model is not to be seen.');
  const newPoints = (of: string) => page.getByRole('button', { name: new RegExp(`of the new ${of}$`) });
  const click = async (x: number, y: number, count: number, of = 'border') => {
    // Until the search tree is there a click finds nothing.
    await expect(async () => {
      await page.mouse.click(box.x + x * box.width, box.y + y * box.height);
      await expect(newPoints(of)).toHaveCount(count, { timeout: 1000 });
    }).toPass();
  };
  await click(0.4, 0.7, 1);
  await click(0.53, 0.7, 2);
  await expect(page.getByRole('button', { name: 'Close the border' })).toHaveAttribute(
    'aria-disabled',
    'true',
  );
  await pane.getByLabel('Model with the line of the zipper').focus();
  for (let i = 0; i < 12; ++i) await page.keyboard.press('Shift+ArrowLeft');
  await click(0.47, 0.7, 3);
  await click(0.6, 0.7, 4);
  await page.getByRole('button', { name: 'Close the border' }).click();
  await expect(page.getByText('Drawn by hand: 1 border')).toBeVisible();
  await expect(parts).toHaveCount(2);
  await expectAccessible(page, 'drawing');

  // The openings that were found are taken over; one is moved by arrow keys, which is one step to undo.
  await page.getByRole('radio', { name: 'Opening' }).click();
  await page.getByRole('button', { name: 'Move the openings found' }).click();
  await expect(page.getByText('Drawn by hand: 1 border, 2 openings')).toBeVisible();
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  const opening = page.getByRole('button', { name: /^Opening [12]$/ }).first();
  const before = await opening.getAttribute('style');
  await opening.focus();
  await page.keyboard.press('Shift+ArrowDown');
  await expect(opening).not.toHaveAttribute('style', before ?? '');
  await expect(page.getByRole('button', { name: 'Undo: Move an opening' })).toBeVisible();
  await page.keyboard.press('Control+z');
  await expect(opening).toHaveAttribute('style', before ?? '');
  await page.keyboard.press('Delete');
  await expect(page.getByText('Drawn by hand: 1 border, 1 opening')).toBeVisible();
  await page.getByRole('button', { name: 'Opening 1' }).focus();
  await page.keyboard.press('Delete');
  await expect(page.getByText('Drawn by hand: 1 border', { exact: true })).toBeVisible();

  // The tip is opened along a cut instead.
  await page.getByRole('radio', { name: 'Cut', exact: true }).click();
  await click(0.48, 0.76, 1, 'cut');
  await click(0.52, 0.79, 2, 'cut');
  await page.getByRole('button', { name: 'End the cut here' }).click();
  await expect(page.getByText('Drawn by hand: 1 border, 1 cut')).toBeVisible();
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await expect(parts).toHaveCount(2);
  await expectAccessible(page, 'cut');

  await expect(page.getByText('Saved', { exact: true })).toBeVisible();
  await page.reload();
  await expect(page.getByText('Drawn by hand: 1 border, 1 cut')).toBeVisible();
  await expect(parts).toHaveCount(2);
  await page.getByRole('button', { name: 'Change the drawing' }).click();
  await page.getByRole('button', { name: 'Find the parts automatically' }).click();
  await expect(page.getByText('The parts were found automatically')).toBeVisible();
  await expect(parts).toHaveCount(3);
});

test('a border around a limb by one line across it: pointer, two fingers, keyboard', async ({ page }) => {
  await openSample(page, 'Star');
  await page.getByRole('button', { name: 'Draw the parts' }).click();
  await page.getByRole('radio', { name: 'Ring' }).click();
  const pane = page.locator('.zippable-model');
  const box = await pane.boundingBox();
  if (box === null) throw new Error('The model is not to be seen.');
  const at = (x: number, y: number) => [box.x + x * box.width, box.y + y * box.height] as const;
  const line = pane.locator('.ring-line line').first();
  const drag = async (from: readonly [number, number], to: readonly [number, number]) => {
    await page.mouse.move(...at(...from));
    await page.mouse.down();
    await page.mouse.move(...at(...to), { steps: 5 });
    await expect(line).toBeVisible();
    await page.mouse.up();
    await expect(line).toHaveCount(0);
  };
  const points = (border: number) =>
    page.getByRole('button', { name: new RegExp(`^Point \\d+ of border ${border}$`) });

  // What makes no border says so.
  await drag([0.05, 0.9], [0.2, 0.85]);
  await expect(page.getByText('The line does not cross the model.')).toBeVisible();
  await page.mouse.click(...at(0.5, 0.5));
  await expect(page.getByText('That was no line')).toBeVisible();
  await expect(page.getByText('The parts were found automatically')).toBeVisible();

  await drag([0.28, 0.36], [0.72, 0.46]);
  await expect(page.getByText('Drawn by hand: 1 border')).toBeVisible();
  await expect(page.getByRole('list', { name: 'Parts' }).getByRole('button')).toHaveCount(2);
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  expect(await points(1).count()).toBeGreaterThanOrEqual(3);
  expect(await points(1).count()).toBeLessThanOrEqual(24);
  await expectAccessible(page, 'ring');

  // A second one, whose line begins on the model, has not turned it; and it is one step to undo.
  const first = points(1).first();
  // The direction from its first point to the one farthest from it, both as one frame shows them: the picture may
  // become smaller meanwhile, for what is said below it.
  const places = () =>
    points(1).evaluateAll((buttons) =>
      buttons.map((button) => button.getBoundingClientRect()).map(({ x, y }) => [x, y] as const),
    );
  const from =
    ([[x0, y0] = [0, 0]]: Awaited<ReturnType<typeof places>>) =>
    (at: readonly [number, number] | undefined) =>
      [(at?.[0] ?? NaN) - x0, (at?.[1] ?? NaN) - y0] as const;
  const seen = await places();
  const apart_px = seen.map((at) => Math.hypot(...from(seen)(at)));
  const farthest = apart_px.indexOf(Math.max(...apart_px));
  expect(apart_px[farthest]).toBeGreaterThan(20);
  const direction_deg = (of: typeof seen) => {
    const [x, y] = from(of)(of[farthest]);
    return (Math.atan2(y, x) * 180) / Math.PI;
  };
  await drag([0.66, 0.6], [0.76, 0.4]);
  await expect(page.getByText('Drawn by hand: 2 borders')).toBeVisible();
  await expect
    .poll(async () => Math.abs(direction_deg(await places()) - direction_deg(seen)))
    .toBeLessThan(3);
  await page.getByRole('button', { name: 'Undo: Draw a ring' }).click();
  await expect(page.getByText('Drawn by hand: 1 border', { exact: true })).toBeVisible();

  // Two fingers move the picture: the line that one of them had begun is given up.
  const leftOf = async () => (await first.boundingBox())?.x ?? NaN;
  const left = await leftOf();
  const touch = await page.context().newCDPSession(page);
  const fingers = async (
    type: 'touchStart' | 'touchMove' | 'touchEnd',
    ...places: readonly (readonly [number, number])[]
  ) => {
    const touchPoints = places.map((place, id) => ({ x: at(...place)[0], y: at(...place)[1], id }));
    await touch.send('Input.dispatchTouchEvent', { type, touchPoints });
  };
  await fingers('touchStart', [0.2, 0.4]);
  await fingers('touchMove', [0.3, 0.42]);
  await expect(line).toBeVisible();
  await fingers('touchStart', [0.3, 0.42], [0.6, 0.4]);
  await expect(line).toHaveCount(0);
  for (const moved of [0.04, 0.08, 0.12]) await fingers('touchMove', [0.3 + moved, 0.42], [0.6 + moved, 0.4]);
  await fingers('touchEnd');
  await expect.poll(leftOf).toBeGreaterThan(left + 10);
  await expect(page.getByText('Drawn by hand: 1 border', { exact: true })).toBeVisible();

  // Its points can be moved like any other border's; without pointing there is a ring in the middle.
  await first.focus();
  await page.keyboard.press('Shift+ArrowDown');
  await expect(page.getByRole('button', { name: 'Undo: Move a point' })).toBeVisible();
  await page.getByRole('button', { name: 'Find the parts automatically' }).click();
  await expect(page.getByText('The parts were found automatically')).toBeVisible();
  const middle = page.getByRole('group', { name: 'Ring in the middle' });
  for (const [i, way] of (['Level', 'Upright'] as const).entries()) {
    await middle.getByRole('button', { name: way }).focus();
    await page.keyboard.press('Enter');
    await expect(page.getByText(`Drawn by hand: ${i + 1} border`)).toBeVisible();
  }
});

test('axe finds nothing serious in the room', { tag: '@screens' }, async ({ page }) => {
  test.skip(backend === 'native', 'the worker serves the same page');
  await openRoom(page);
  await expectAccessible(page, 'empty');
  await chooseSample(page, 'Star');
  await expectAccessible(page, 'preview', 'ribbon');
  await page.getByRole('radio', { name: 'Zipped' }).click();
  await expectAccessible(page, 'zipped');
  await page.getByRole('radio', { name: 'Sheets to cut' }).click();
  await expectAccessible(page, 'sheets', 'sheets');
});
