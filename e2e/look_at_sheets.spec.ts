// SPDX-License-Identifier: GPL-3.0-or-later
// The sheets of a cutting plan are looked at: zoomed, moved, one by one and all together.
import type { Locator, Page } from '@playwright/test';
import { address, backend, expect, expectAccessible, makeRibbon, strip, test } from './page';

test.skip(backend !== 'wasm', 'the mock makes reliefs only; the worker serves the same page');

const stage = (page: Page) => page.getByRole('group', { name: 'Sheets to cut' });
const drawing = (page: Page) => stage(page).getByRole('img', { name: /pieces on \d+ sheets/ });
const tool = (page: Page, name: string) => page.getByRole('button', { name, exact: true });

/** A star on sheets so small that there are several. */
async function openSheets(page: Page): Promise<void> {
  await page.goto(address());
  await expect(page.getByRole('heading', { name: 'Or start from a sample' })).toBeVisible();
  const link = '#/open?v=1&name=Star&zippable=star&zippable.bed_x_mm=150&zippable.bed_y_mm=120';
  await page.evaluate((hash) => (location.hash = hash), link);
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await makeRibbon(page);
  await page.getByRole('radio', { name: 'Sheets to cut' }).click();
  await expect(drawing(page)).toBeVisible();
}

/** What lies under a place of the window, mm, and how many pixels a millimetre has. */
const under = (svg: Locator, [x, y]: readonly [number, number]) =>
  svg.evaluate(
    (element: SVGSVGElement, at) => {
      const matrix = element.getScreenCTM() ?? new DOMMatrix();
      const place = new DOMPoint(at[0], at[1]).matrixTransform(matrix.inverse());
      return { mm: [place.x, place.y], scale: matrix.a };
    },
    [x, y] as const,
  );

type Under = Awaited<ReturnType<typeof under>>;
/** How far two places of the sheet are apart on the screen. */
const apart_px = (a: Under, b: Under): number =>
  a.scale * Math.hypot(...[0, 1].map((axis) => (a.mm[axis] ?? NaN) - (b.mm[axis] ?? NaN)));

/** A whole pixel: wheels and mice know no others. */
async function middleOf(locator: Locator): Promise<readonly [number, number]> {
  const box = await locator.boundingBox();
  if (box === null) throw new Error('It is not shown.');
  return [Math.round(box.x + box.width / 2), Math.round(box.y + box.height / 2)];
}

test('sheets are zoomed about the pointer, dragged, fitted and stepped through', async ({ page }) => {
  await openSheets(page);
  const svg = drawing(page);
  const count = Number(/on (\d+) sheets/.exec((await svg.getAttribute('aria-label')) ?? '')?.[1]);
  expect(count).toBeGreaterThan(1);
  await expect(svg.locator('.sheet-paper')).toHaveCount(count);

  // By keys: one sheet after the other, larger, moved, and all of them again.
  await stage(page).focus();
  await page.keyboard.press('PageDown');
  await expect(page.getByText(`Sheet 1 of ${count}`)).toBeVisible();
  await expect(svg.locator('.sheet-paper')).toHaveCount(1);
  await page.keyboard.press('PageDown');
  await expect(page.getByText(`Sheet 2 of ${count}`)).toBeVisible();
  const [x, y] = await middleOf(svg);
  const whole = await under(svg, [x, y]);
  for (let i = 0; i < 6; ++i) await page.keyboard.press('+');
  const large = await under(svg, [x, y]);
  expect(large.scale).toBeCloseTo(whole.scale * 1.25 ** 6, 3);
  await page.keyboard.press('ArrowRight');
  expect((await under(svg, [x, y])).mm[0]).toBeGreaterThan(large.mm[0] ?? Infinity);
  await page.keyboard.press('0');
  expect((await under(svg, [x, y])).scale).toBeCloseTo(whole.scale, 3);
  await expect(page.getByRole('main', { name: 'Zippable' })).toBeVisible(); // no key went to the rooms
  await page.keyboard.press('Home');
  await expect(svg.locator('.sheet-paper')).toHaveCount(count);

  // By hand: what is under the pointer stays there, and follows it.
  await tool(page, 'Next sheet').click();
  await page.mouse.move(x, y);
  for (let i = 0; i < 4; ++i) await page.mouse.wheel(0, -200);
  await expect.poll(async () => (await under(svg, [x, y])).scale).toBeGreaterThan(3 * whole.scale);
  const at = [x + 40, y - 30] as const;
  const before = await under(svg, at);
  await page.mouse.move(...at);
  await page.mouse.wheel(0, -100);
  await expect.poll(async () => (await under(svg, at)).scale).toBeGreaterThan(1.1 * before.scale);
  const after = await under(svg, at);
  expect(apart_px(before, after)).toBeLessThan(0.5);
  await page.mouse.down();
  await page.mouse.move(x - 20, y + 30, { steps: 4 });
  await page.mouse.up();
  const dragged = await under(svg, [x - 20, y + 30]);
  expect(apart_px(after, dragged)).toBeLessThan(0.5);
  await page.mouse.dblclick(x, y);
  await expect(tool(page, 'Fit')).toBeDisabled();
  await expectAccessible(page, 'sheets');
});

test('on a phone two fingers zoom the sheets', async ({ browser }) => {
  const context = await browser.newContext({ viewport: { width: 390, height: 844 }, hasTouch: true });
  const page = await context.newPage();
  await openSheets(page);
  const svg = drawing(page);
  const { height = 0 } = (await svg.boundingBox()) ?? {};
  expect(height).toBeGreaterThan(120);
  await tool(page, 'Next sheet').tap();
  const [x, y] = await middleOf(svg);
  const whole = await under(svg, [x, y]);
  const session = await context.newCDPSession(page);
  const touch = (type: 'touchStart' | 'touchMove' | 'touchEnd', apart: number | null) =>
    session.send('Input.dispatchTouchEvent', {
      type,
      touchPoints:
        apart === null
          ? []
          : [
              { x: x - apart / 2, y, id: 0 },
              { x: x + apart / 2, y, id: 1 },
            ],
    });
  await touch('touchStart', 60);
  for (const apart of [80, 110, 150, 180]) await touch('touchMove', apart);
  await touch('touchEnd', null);
  const large = await under(svg, [x, y]);
  expect(large.scale / whole.scale).toBeCloseTo(3, 1);
  for (const axis of [0, 1])
    expect(Math.abs((large.mm[axis] ?? NaN) - (whole.mm[axis] ?? NaN))).toBeLessThan(1);
  await expectAccessible(page, 'sheets on a phone');
  await tool(page, 'Fit').tap();
  await expect(tool(page, 'Fit')).toBeDisabled();
  await context.close();
});
