// SPDX-License-Identifier: GPL-3.0-or-later
// A relief on stairs, strips or a base of several parts, looked at in pieces and taken along.
import { readFileSync } from 'node:fs';
import { backend, expect, expectAccessible, fileOf, openSample, solve, strip, test } from './page';

test.skip(backend !== 'wasm', 'the page does the same with the worker');

test('stairs and strips are pulled apart, and their plan is saved', async ({ page }) => {
  test.setTimeout(420_000);
  await openSample(page);
  const view = (name: string) => page.getByRole('radio', { name, exact: true });
  const shape = page.getByRole('combobox', { name: 'Shape of the base' });
  const bar = page.getByRole('region', { name: 'Pieces', exact: true });
  const numbers = page.locator('.fw-marker');
  // A plate has no pieces.
  await expect(view('In pieces')).toBeHidden();
  await shape.selectOption('Stairs');
  await view('In pieces').click();
  await expect(bar).toContainText(/5 pieces, \d+\.\d\sml/, { timeout: 120_000 });
  await expect(numbers).toHaveText(['1', '2', '3', '4', '5']);
  // By keyboard alone.
  const slider = page.getByRole('slider', { name: 'Pulled apart', exact: true });
  await slider.focus();
  const before = await numbers.first().boundingBox();
  await slider.press('End');
  await expect(slider).toHaveAttribute('aria-valuetext', /^100\s%$/);
  await expect.poll(async () => (await numbers.first().boundingBox())?.y).not.toBeCloseTo(before?.y ?? 0, 0);
  await expectAccessible(page, 'a relief in pieces');

  // Strips have an angle, stairs a depth.
  await shape.selectOption('Strips');
  await expect(page.getByRole('textbox', { name: 'Angle between strips', exact: true })).toBeVisible();
  await expect(page.getByRole('textbox', { name: 'Depth of the base', exact: true })).toBeHidden();
  const count = page.getByRole('textbox', { name: 'Steps or strips', exact: true });
  await count.fill('3');
  await count.press('Enter');
  await expect(bar).toContainText(/3 pieces/, { timeout: 120_000 });
  await page.setViewportSize({ width: 390, height: 844 });
  await expect(bar).toBeVisible();
  const box = await bar.boundingBox();
  expect((box?.x ?? 0) + (box?.width ?? 999)).toBeLessThanOrEqual(390);
  await expect(view('Pieces')).toBeVisible();
  const chosen = await view('Pieces').boundingBox();
  expect((chosen?.x ?? 0) + (chosen?.width ?? 999)).toBeLessThanOrEqual(390);
  await page.setViewportSize({ width: 1280, height: 800 });

  await solve(page);
  const saved = page.waitForEvent('download', { timeout: 120_000 });
  await page.getByRole('button', { name: 'Export another format' }).click();
  await page.getByRole('menuitem', { name: 'Placement plan, SVG' }).click();
  const svg = readFileSync(await (await saved).path(), 'utf8');
  expect([...svg.matchAll(/id="piece-\d"/g)]).toHaveLength(3);

  // Without pieces the view falls back to the relief.
  await shape.selectOption('Flat');
  await expect(view('In pieces')).toBeHidden();
  await expect(view('Relief')).toBeChecked();
});

test('a base of several blocks carries the relief in as many pieces', async ({ page }) => {
  test.setTimeout(420_000);
  await openSample(page);
  const view = (name: string) => page.getByRole('radio', { name, exact: true });
  const bar = page.getByRole('region', { name: 'Pieces', exact: true });
  const file = page.getByLabel('File of the base');
  const faces = '1 3 2|2 3 4|5 6 7|6 8 7|1 2 5|2 6 5|3 7 4|4 7 8|1 5 3|3 5 7|2 4 6|4 8 6'.split('|');
  /** Blocks from their lower to their upper corners. */
  const blocks = (...corners: readonly (readonly [number[], number[]])[]) =>
    fileOf(
      'blocks.obj',
      corners
        .flatMap(([low, high], block) => [
          ...[0, 1, 2, 3, 4, 5, 6, 7].map(
            (i) => `v ${[0, 1, 2].map((k) => ((i >> k) & 1 ? high : low)[k]).join(' ')}`,
          ),
          ...faces.map(
            (face) =>
              `f ${face
                .split(' ')
                .map((v) => Number(v) + 8 * block)
                .join(' ')}`,
          ),
        ])
        .join('\n'),
    );
  const wall = [
    [-150, -150, -60],
    [150, 150, -30],
  ] as const;
  await file.setInputFiles(
    blocks(
      [[...wall[0]], [...wall[1]]],
      [
        [-15, -150, -28],
        [30, 10, -8],
      ],
    ),
  );
  await expect(strip(page, 'Preview up to date')).toBeVisible({ timeout: 120_000 });
  await view('In pieces').click();
  await expect(bar).toContainText(/2 pieces, \d+(\.\d)?\sml/, { timeout: 120_000 });
  await expect(page.locator('.fw-marker')).toHaveText(['1', '2']);
  await expectAccessible(page, 'a relief on several blocks');

  // As one surface they are no pieces.
  const parts = page.getByRole('combobox', { name: 'Parts of the base' });
  await parts.selectOption('As one surface');
  await expect(view('In pieces')).toBeHidden({ timeout: 120_000 });
  await parts.selectOption('Each by itself');
  await expect(view('In pieces')).toBeVisible({ timeout: 120_000 });

  // Blocks that reach into each other say what to do, and the last relief stays.
  await file.setInputFiles(
    blocks(
      [[...wall[0]], [...wall[1]]],
      [
        [-15, -150, -40],
        [30, 10, -8],
      ],
    ),
  );
  await view('In pieces').click({ timeout: 120_000 });
  await expect(page.getByText(/Parts 1 and 2 of the base overlap.*move them apart/)).toBeVisible({
    timeout: 120_000,
  });
});
