// SPDX-License-Identifier: GPL-3.0-or-later
// A model is read once: the page asks what becomes of it, and every room offers what the project has.
import {
  backend,
  ballObj,
  expect,
  expectAccessible,
  fileOf,
  inEveryLook,
  openModel,
  openPage,
  strip,
  test,
} from './page';

const plate = fileOf(
  'plate.svg',
  '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="40mm" viewBox="0 0 60 40"><rect x="5" y="5" width="50" height="30" fill="none" stroke="#f00"/></svg>',
);
const ball = fileOf('ball.obj', ballObj());

test('a model dropped on the start page is made into what one chooses, and then into the others', async ({
  page,
}) => {
  test.skip(backend === 'mock', 'the mock makes reliefs only');
  await openPage(page);
  await openModel(page, ball, 'Thermoform');
  await expect(page.getByRole('button', { name: 'Form at full detail' })).toBeVisible();
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  for (const [room, made] of [
    ['Relief', 'Solve at full detail'],
    ['Zippable', 'Make the ribbon'],
  ] as const) {
    await page.getByRole('link', { name: room, exact: true }).click();
    await page.getByRole('button', { name: 'Use ball.obj' }).click();
    await expect(page.getByRole('button', { name: made })).toBeVisible();
    await expect(strip(page, 'Preview up to date')).toBeVisible();
    await expect(page.locator('.model-row strong')).toHaveText('ball.obj');
  }
  // Taking it is a step like any other.
  await page.keyboard.press('Control+z');
  await expect(page.getByRole('button', { name: 'Use ball.obj' })).toBeVisible();
  // Closed, the question leaves everything as it was.
  await page.getByRole('link', { name: 'Formwright, start' }).click();
  await page.getByLabel('Model or project file').setInputFiles(ball);
  await expect(page.getByRole('dialog')).toBeVisible();
  await page.keyboard.press('Escape');
  await expect(page.getByRole('dialog')).toBeHidden();
  await expect(page.getByRole('heading', { name: 'What will you make?' })).toBeVisible();
});

test('a drawing and a strange file find their rooms from the start page', async ({ page }) => {
  test.skip(backend === 'mock', 'the mock knows no drawings');
  await openPage(page);
  await page.getByLabel('Model or project file').setInputFiles(plate);
  await expect(strip(page, 'Job ready')).toBeVisible();
  await page.getByRole('link', { name: 'Formwright, start' }).click();
  await page.getByLabel('Model or project file').setInputFiles(fileOf('notes.txt', 'words'));
  await expect(page.getByRole('alert').getByText('Could not open notes.txt')).toBeVisible();
});

test(
  'the question what to make of a model, and rooms with nothing in them',
  { tag: '@screens' },
  async ({ page }) => {
    test.skip(backend === 'native', 'the worker serves the same page');
    await openPage(page);
    await page.getByLabel('Model or project file').setInputFiles(ball);
    await expect(page.getByRole('dialog')).toBeVisible();
    await expectAccessible(page, 'the question', 'question');
    await page.keyboard.press('Escape');
    for (const room of ['Relief', 'Thermoform', 'Zippable', 'Evidence']) {
      await page.getByRole('link', { name: room, exact: true }).click();
      await expect(page.locator('.empty-room')).toBeVisible();
      await inEveryLook(page, async () => {
        const wide = await page.locator('.empty-room').evaluate((shown) => shown.scrollWidth);
        expect(wide).toBeLessThanOrEqual(page.viewportSize()?.width ?? 0); // nothing is cut off
      });
      await expectAccessible(page, room);
    }
  },
);
