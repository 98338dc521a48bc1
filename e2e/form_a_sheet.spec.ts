// SPDX-License-Identifier: GPL-3.0-or-later
import type { Page } from '@playwright/test';
import { readFileSync } from 'node:fs';
import {
  backend,
  ballObj,
  chooseSample,
  expect,
  expectAccessible,
  fileOf,
  goToRoom,
  openPage,
  readStl,
  strip,
  test,
} from './page';

test.skip(backend === 'mock', 'the mock makes reliefs only');

async function openRoom(page: Page): Promise<void> {
  await openPage(page);
  await goToRoom(page, 'Thermoform');
  await expect(page.getByText('A shell starts from a model.')).toBeVisible();
}

async function openSample(page: Page, title: string): Promise<void> {
  await openRoom(page);
  await chooseSample(page, title);
}

/** Coarse sheets are formed quickly; what is told here does not depend on how fine they are. */
async function coarse(page: Page): Promise<void> {
  await page.getByRole('button', { name: /^Accuracy/ }).click();
  await page.getByRole('textbox', { name: 'Triangles' }).fill('1500');
  await page.getByRole('textbox', { name: 'Triangles' }).press('Enter');
  await expect(strip(page, 'Preview up to date')).toBeVisible();
}

async function form(page: Page): Promise<void> {
  await page.getByRole('button', { name: 'Form at full detail' }).click();
  await expect(strip(page, 'Sheet formed')).toBeVisible({ timeout: 150_000 });
}

const timeline = (page: Page) => page.getByRole('slider', { name: 'Moment of forming' });

/** Columns of the vertices of a binary PLY, and how many there are. */
function plyHeader(bytes: Buffer): { vertices: number; columns: string[] } {
  const header = bytes.toString('latin1', 0, bytes.indexOf('end_header'));
  const vertices = Number(/element vertex (\d+)/.exec(header)?.[1]);
  const body = header.slice(header.indexOf('element vertex'), header.indexOf('element face'));
  return { vertices, columns: [...body.matchAll(/property \S+ (\S+)/g)].map((match) => match[1] ?? '') };
}

for (const sample of ['Mountain', 'Cat'])
  test(`${sample}: move, form, look at each moment, download the sheet`, async ({ page }) => {
    await openSample(page, sample);
    await page.getByRole('button', { name: /^Move the model/ }).focus();
    await page.keyboard.press('Shift+ArrowRight');
    await expect(page.getByRole('button', { name: /^Move the model. Now at 10, 0 mm/ })).toBeVisible();
    await page.keyboard.press('Control+z');
    await expect(page.getByRole('button', { name: /^Move the model. Now at 0, 0 mm/ })).toBeVisible();
    await page.keyboard.press('Control+Shift+z');
    await expect(strip(page, 'Preview up to date')).toBeVisible();
    await coarse(page);
    await form(page);

    await timeline(page).focus();
    await expect(timeline(page)).toHaveAttribute('aria-valuetext', /vacuum, \d+ % in contact/);
    await page.keyboard.press('Home');
    await expect(timeline(page)).toHaveAttribute('aria-valuetext', /^0\.0\ss of .*, sag, 0 % in contact/);
    await page.keyboard.press('PageUp');
    await expect(timeline(page)).toHaveAttribute('aria-valuetext', /^1\.0\ss of .*, sag/);
    await page.keyboard.press('PageUp');
    await expect(timeline(page)).toHaveAttribute('aria-valuetext', /, raise, /);
    await page.keyboard.press('End');

    await page.getByRole('radio', { name: 'Stretch' }).click();
    await expect(page.getByRole('img', { name: /^Stretch: colours from 1/ })).toBeVisible();
    await page.getByRole('radio', { name: 'Thickness' }).click();
    await expect(page.getByRole('img', { name: /^Thickness: .* thinnest 0\.\d+\smm/ })).toBeVisible();

    const waiting = page.waitForEvent('download');
    await page.getByRole('button', { name: 'Export something else' }).click();
    await page
      .getByRole('menuitem', { name: /^Formed sheet.*/ })
      .last()
      .click();
    const download = await waiting;
    expect(download.suggestedFilename()).toMatch(/sheet\.ply$/);
    const { vertices, columns } = plyHeader(readFileSync(await download.path()));
    expect(vertices).toBeGreaterThan(500);
    for (const column of ['sheet_x_mm', 'sheet_y_mm', 'thickness_mm', 'stretch', 'contact_s'])
      expect(columns).toContain(column);
  });

test('the print and the mould of a sheet, made when they are asked for', async ({ page }) => {
  await openSample(page, 'Hemisphere');
  await coarse(page);
  await page.keyboard.press('Control+e'); // forms the sheet first
  const print = await page.waitForEvent('download', { timeout: 150_000 });
  expect(print.suggestedFilename()).toMatch(/print\.pdf$/);
  expect(readFileSync(await print.path()).toString('latin1', 0, 5)).toBe('%PDF-');
  await page.getByRole('radio', { name: 'Texture' }).click();
  await expect(page.getByRole('img', { name: /^The print/ })).toBeVisible();
  await page.getByRole('radio', { name: 'Undercut' }).click();
  await expect(page.getByRole('img', { name: /^Overhang/ })).toBeVisible();
  await expect(page.getByRole('progressbar')).toBeHidden();
  await page.getByRole('button', { name: 'Export something else' }).click();
  const waiting = page.waitForEvent('download', { timeout: 150_000 });
  await page.getByRole('menuitem', { name: /^Mould, STL/ }).click();
  const solid = readStl(readFileSync(await (await waiting).path()));
  expect(solid.closed).toBe(true);
});

test('the film plays with Space and stops at its end', async ({ page }) => {
  await openSample(page, 'Pyramid');
  const end = Number(await timeline(page).getAttribute('aria-valuemax'));
  await page.locator('.fw-view').focus();
  await page.keyboard.press('Space');
  await expect(page.getByRole('button', { name: 'Pause' })).toBeVisible();
  await expect(page.getByRole('button', { name: 'Play' })).toBeVisible();
  expect(Number(await timeline(page).getAttribute('aria-valuenow'))).toBeCloseTo(end, 1);
});

test('a model dragged beyond the clamp is said, and form it stops at once', async ({ page }) => {
  await openSample(page, 'Pyramid');
  const handle = page.getByRole('button', { name: /^Move the model/ });
  await handle.hover();
  // Notes that come and a camera that turns move the handle: it is taken where it has stood still.
  let box = await handle.boundingBox();
  for (let still = 0; still < 3;) {
    await page.waitForTimeout(400);
    const before = box;
    box = await handle.boundingBox();
    still = before?.x === box?.x && before?.y === box?.y ? still + 1 : 0;
  }
  if (box === null) throw new Error('The handle is not to be seen.');
  await page.mouse.move(box.x + 14, box.y + 14);
  await page.mouse.down();
  await page.mouse.move(box.x + 260, box.y - 20, { steps: 8 });
  await page.mouse.up();
  await expect(page.getByText(/^The model reaches .* beyond the clamp$/)).toBeVisible();
  await page.keyboard.press('Control+z');
  await expect(page.getByText(/beyond the clamp$/)).toBeHidden();
  await expect(strip(page, 'Preview up to date')).toBeVisible();

  await page.getByRole('button', { name: 'Form at full detail' }).click();
  await expect(page.getByRole('progressbar')).toBeVisible();
  await page.keyboard.press('Escape');
  await expect(page.getByRole('button', { name: 'Form at full detail' })).toBeVisible({ timeout: 5000 });
});

test('a wrong file is said in words and the work stays', async ({ page }) => {
  await openSample(page, 'Pyramid');
  await page.getByLabel('Model or project file').setInputFiles(fileOf('notes.obj', 'this is no model'));
  await expect(page.getByRole('alert').getByText('Could not open notes.obj')).toBeVisible();
  await expect(page.locator('.model-row strong')).toHaveText('Pyramid');
});

test('a model with its material, and a reload that keeps the work of both rooms', async ({ page }) => {
  await openRoom(page);
  const files = [fileOf('ball.mtl', 'newmtl a\nKd 1 0 0\n'), fileOf('ball.obj', ballObj())];
  await page.getByLabel('Model or project file').setInputFiles(files);
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await coarse(page);
  await form(page);
  await goToRoom(page, 'Relief');
  await page.getByLabel('Model or project file').setInputFiles(fileOf('other.obj', ballObj()));
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await expect(page.getByText('Saved', { exact: true })).toBeVisible();
  await page.reload();
  await expect(page.locator('.model-row strong')).toHaveText('other.obj');
  await goToRoom(page, 'Thermoform');
  await expect(strip(page, 'Sheet formed')).toBeVisible();
  await expect(page.locator('.model-row strong')).toHaveText('ball.obj');
  await expect(page.getByRole('list', { name: 'Earlier results' }).getByRole('button')).toHaveCount(1);
});

test('axe finds nothing serious in the room', { tag: '@screens' }, async ({ page }) => {
  test.skip(backend === 'native', 'the worker serves the same page');
  await openRoom(page);
  await expectAccessible(page, 'empty');
  await chooseSample(page, 'Pyramid');
  await expectAccessible(page, 'preview', 'shell');
  await page.getByRole('button', { name: /^Material/ }).click();
  await expectAccessible(page, 'folded group');
});
