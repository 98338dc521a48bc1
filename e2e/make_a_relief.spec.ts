// SPDX-License-Identifier: GPL-3.0-or-later
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import {
  backend,
  ballObj,
  expect,
  expectAccessible,
  fileOf,
  openModel,
  openPage,
  openSample,
  readStl,
  solve,
  strip,
  test,
} from './page';

/** Of the file that says how a result was made. */
interface Step {
  readonly made_by: {
    readonly operation: string;
    readonly job: string;
    readonly inputs: Readonly<Record<string, { readonly file_name: string; readonly sha256: string }>>;
  };
  readonly files: Readonly<Record<string, { readonly sha256: string }>>;
}

test('from a sample to a solid of the asked thickness', async ({ page }) => {
  await openSample(page, 'Bust');
  const thickness = page.getByRole('textbox', { name: 'Thickness' });
  await thickness.fill('4');
  await thickness.press('Enter');
  await solve(page);
  await expect(page.getByRole('contentinfo').locator('.job-text')).toContainText(
    /Solved in .* than the model simply squashed/,
  );
  const waiting = page.waitForEvent('download');
  await page.getByRole('button', { name: 'Export STL' }).click();
  const download = await waiting;
  expect(download.suggestedFilename()).toMatch(/-4mm\.stl$/);
  const solid = readStl(readFileSync(await download.path()));
  expect(solid.closed).toBe(true);
  expect(solid.triangles).toBeGreaterThan(1000);
  if (backend === 'mock') return; // its solid is only the squashed model
  const plate = Number((await page.getByRole('textbox', { name: 'Plate' }).inputValue()).replace(',', '.'));
  const width = Number(await page.getByRole('textbox', { name: 'Width' }).inputValue());
  expect(solid.size[0]).toBeCloseTo(width, 3);
  expect(solid.size[2]).toBeCloseTo(4 + plate, 3);
  await expect(page.getByText(/^Watertight, /)).toBeVisible();
});

test('a file, several thicknesses, and back to an earlier result', async ({ page }) => {
  await openPage(page);
  await openModel(page, fileOf('ball.obj', ballObj()));
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await expect(page.getByText('ball.obj', { exact: true })).toBeVisible();
  await expect(page.locator('.model-picture')).toHaveAttribute('style', /blob:/);
  await solve(page);
  const thickness = page.getByRole('textbox', { name: 'Thickness' });
  const first = await thickness.inputValue();
  await thickness.fill('3');
  await thickness.press('Enter');
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await solve(page);
  const results = page.getByRole('list', { name: 'Earlier results' }).getByRole('button');
  await expect(results).toHaveCount(2);
  await results.nth(1).click();
  await expect(thickness).toHaveValue(first);
  await expect(strip(page, 'Relief ready')).toBeVisible();
  await page.keyboard.press('Control+z');
  await expect(thickness).toHaveValue('3.0');
});

test('cancel a solve and go on', async ({ page }) => {
  await openSample(page, 'Bust');
  await page.getByRole('button', { name: 'Solve at full detail' }).click();
  await expect(page.getByRole('progressbar')).toBeVisible();
  await page.keyboard.press('Escape');
  await expect(page.getByRole('button', { name: 'Solve at full detail' })).toBeVisible({ timeout: 5000 });
  await solve(page);
});

test('other formats from the menu, and how they were made', async ({ page }) => {
  test.skip(backend === 'mock', 'the mock makes STL only');
  await openPage(page);
  await openModel(page, fileOf('ball.obj', ballObj()));
  await solve(page);
  const exported = async (label: string) => {
    await page.getByRole('button', { name: 'Export another format' }).click();
    const waiting = page.waitForEvent('download');
    await page.getByRole('menuitem', { name: new RegExp(`^${label}`) }).click();
    return readFileSync(await (await waiting).path());
  };
  for (const [label, magic] of [
    ['3MF', 'PK'],
    ['Height map', '\x89PNG'],
  ] as const)
    expect((await exported(label)).toString('latin1', 0, magic.length)).toBe(magic);
  const stl = await exported('STL');
  const { steps } = JSON.parse((await exported('How it was made')).toString()) as { steps: Step[] };
  expect(steps.map(({ made_by }) => made_by.operation)).toEqual(['import', 'relief']);
  const [read, made] = steps;
  expect(read?.made_by.inputs.mesh?.file_name).toBe('ball.obj');
  expect(made?.made_by.inputs.mesh?.sha256).toBe(read?.files['model.ply']?.sha256);
  expect(stl.toString('latin1', 0, 80)).toContain(`, job ${made?.made_by.job}`);
  expect(made?.files['relief.stl']?.sha256).toBe(createHash('sha256').update(stl).digest('hex'));
});

test('a viewpoint set from the view stays as far away', async ({ page }) => {
  test.skip(backend === 'mock', 'the mock knows one viewpoint');
  await openPage(page);
  await openModel(page, fileOf('ball.obj', ballObj()));
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await page.getByRole('button', { name: /^Advanced/ }).click();
  const angle = page.getByRole('textbox', { name: 'Field of view' });
  await expect(angle).toHaveValue(/^20/);
  const set = page.getByRole('button', { name: 'Use this view' });
  for (let turn = 0; turn < 3; ++turn) {
    await page.getByLabel('Model and relief').focus();
    await page.keyboard.press('Shift+ArrowRight');
    await page.keyboard.press('+'); // coming nearer to look is not coming nearer with the eye
    await set.click();
    await expect(strip(page, 'Preview up to date')).toBeVisible();
    await expect(set).toBeDisabled();
  }
  const now = Number((await angle.inputValue()).replace(',', '.'));
  expect(Math.abs(now - 20)).toBeLessThan(2.5); // the ball is a little wider from some sides
});

test('following the view ends with the model it was followed for', async ({ page }) => {
  await openSample(page, 'Bust');
  await page.getByText('Follow the view', { exact: true }).click();
  await expect(page.getByRole('switch', { name: 'Follow the view' })).toBeChecked();
  await page.getByLabel('Model or project file').setInputFiles(fileOf('ball.obj', ballObj()));
  await expect(page.getByText('ball.obj', { exact: true })).toBeVisible();
  await expect(page.getByRole('switch', { name: 'Follow the view' })).not.toBeChecked();
});

test('beside the relief stands the model, or the model simply squashed', async ({ page }) => {
  test.skip(backend === 'mock', 'all that the mock makes is squashed');
  await openSample(page, 'Bust');
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  const view = page.getByRole('radiogroup', { name: 'View' });
  const beside = page.getByRole('radiogroup', { name: 'Beside the relief' });
  await view.getByRole('radio', { name: 'Relief' }).click();
  await expect(beside).toHaveCount(0);
  await view.getByRole('radio', { name: 'Swipe' }).click();
  const names = page.locator('.fw-tag');
  await expect(names).toHaveText(['Original', 'Relief']);
  await beside.getByRole('radio', { name: 'Model', exact: true }).focus();
  await page.keyboard.press('ArrowRight');
  await expect(names).toHaveText(['Squashed', 'Relief']);
  await expectAccessible(page, 'squashed');

  // It follows the relief, is not one of its results, and gives way to the model again.
  const thickness = page.getByRole('textbox', { name: 'Thickness' });
  await thickness.fill('12');
  await thickness.press('Enter');
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await expect(page.getByText('Squashing the model')).toHaveCount(0);
  await expect(names).toHaveText(['Squashed', 'Relief']);
  await solve(page);
  await expect(names).toHaveText(['Squashed', 'Relief']);
  await expect(page.getByRole('list', { name: 'Earlier results' }).getByRole('button')).toHaveCount(1);
  await beside.getByRole('radio', { name: 'Model', exact: true }).click();
  await expect(names).toHaveText(['Original', 'Relief']);
});
