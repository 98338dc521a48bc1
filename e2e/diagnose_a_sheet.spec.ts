// SPDX-License-Identifier: GPL-3.0-or-later
import type { Page } from '@playwright/test';
import { readFileSync } from 'node:fs';
import { measuredObject, scannedSheet } from './measured_object';
import {
  backend,
  chooseSample,
  expect,
  expectAccessible,
  fileOf,
  goToRoom,
  openPage,
  strip,
  test,
} from './page';

test.skip(backend === 'mock', 'the mock makes reliefs only');
test.setTimeout(400_000);

const seen = { timeout: 300_000 };

async function openRoom(page: Page): Promise<void> {
  await openPage(page);
  await goToRoom(page, 'Evidence');
  await expect(
    page.getByText('Find out why a formed part came out wrong, and what to change in the next print.'),
  ).toBeVisible();
}

const give = (page: Page, files: readonly ReturnType<typeof fileOf>[]) =>
  page.getByLabel('Model or project file').setInputFiles([...files]);

async function openObject(page: Page): Promise<void> {
  await openRoom(page);
  await give(page, measuredObject());
  await expect(strip(page, 'Compared with the settings as they are')).toBeVisible();
}

/** As little as still names the cause. */
async function quickly(page: Page): Promise<void> {
  await page.getByRole('switch', { name: 'Two causes at once' }).click();
  await page.getByRole('switch', { name: 'Propose a measurement' }).click();
  await page.getByRole('textbox', { name: 'Triangles' }).fill('500');
  await page.getByRole('textbox', { name: 'Triangles' }).press('Enter');
}

const run = (page: Page, name: 'Diagnose' | 'Calibrate') =>
  page.locator('.inspector-foot').getByRole('button', { name, exact: true }).click();

test(
  'three files, a named cause, the extended model, the report, the next print, a reload',
  { tag: '@screens' },
  async ({ page }) => {
    await openObject(page);
    await expect(page.getByRole('img', { name: /^Measured height: .*/ })).toBeVisible();
    await expect(page.getByText('196 points')).toHaveCount(2);
    await page.getByRole('application', { name: /^Points of the sheet/ }).focus();
    await page.keyboard.press('ArrowRight');
    await expect(page.getByText(/^At -?−?\d.* apart$/)).toBeVisible();
    await expectAccessible(page, 'compared');

    await quickly(page);
    await run(page, 'Diagnose');
    await expect(page.getByRole('progressbar')).toBeVisible();
    await expect(strip(page, 'Diagnosis ready')).toBeVisible(seen);
    const cause = page.getByRole('button', { name: /^Uneven heating, side to side/ });
    await cause.click();
    await expect(page.getByText('What to do.')).toBeVisible();
    await expect(page.getByRole('img', { name: /^Points left out .* to .*mm, −\d+\s%/ })).toBeVisible();

    const distances = page.getByRole('img', { name: /^Distances between measured and simulated/ });
    const meanOf = async () =>
      Number(/mean ([\d.]+)/.exec((await distances.getAttribute('aria-label')) ?? '')?.[1]);
    const calibrated = await meanOf();
    await page.getByRole('switch', { name: 'Show the simulation with this cause included' }).click();
    await expect(distances).toHaveAttribute('aria-label', /simulated, with the cause/);
    expect(await meanOf()).toBeLessThan(calibrated);
    await expectAccessible(page, 'diagnosed', 'evidence');

    await page.getByRole('radio', { name: 'On the object' }).click();
    await expect(page.getByText(/^Arrows from measured to simulated/)).toBeVisible();
    await expectAccessible(page, 'on the object');
    await page.getByRole('button', { name: 'See the print before and after' }).click();
    await expect(page.getByRole('radio', { name: 'Next print' })).toBeChecked();
    for (const kind of ['as the calibrated simulation', 'as the simulation with the cause'])
      await expect(
        page.getByRole('img', {
          name: new RegExp(`^Test pattern on the flat sheet, ${kind} has it printed`),
        }),
      ).toBeVisible();
    await expect(
      page.getByRole('img', { name: /^Shift of the print’s features.* mm on average/ }),
    ).toBeVisible();
    await expectAccessible(page, 'next print');
    await page.getByRole('radio', { name: 'Flat maps' }).click();

    const waiting = page.waitForEvent('download');
    await page.getByRole('button', { name: 'Download the results, or stop using them' }).click();
    await page.getByRole('menuitem', { name: /^Download report/ }).click();
    const report = await waiting;
    expect(report.suggestedFilename()).toMatch(/\.html$/);
    expect(readFileSync(await report.path(), 'utf8')).toContain('Uneven heating, side to side');

    await page.getByRole('button', { name: 'Use in the next print' }).click();
    await expect(page.getByRole('button', { name: 'Used in the next print' })).toBeVisible();
    await goToRoom(page, 'Thermoform');
    await chooseSample(page, 'Pyramid');
    await expect(page.getByText('Machine: Diagnosed machine')).toBeVisible();
    await expect(page.getByText('Saved', { exact: true })).toBeVisible();

    await page.reload();
    await expect(page.getByText('Machine: Diagnosed machine')).toBeVisible();
    await page.getByRole('button', { name: 'Form without the machine profile' }).click();
    await expect(page.getByText('Machine: Diagnosed machine')).toBeHidden();
    await page.keyboard.press('Control+z');
    await expect(page.getByText('Machine: Diagnosed machine')).toBeVisible();
    await goToRoom(page, 'Evidence');
    await expect(strip(page, 'Diagnosis ready')).toBeVisible();
    await expect(cause).toBeVisible();
    await expect(page.getByRole('img', { name: /^Height, simulated minus measured/ })).toBeVisible();
  },
);

test('what has changed since a good part', async ({ page }) => {
  await openObject(page);
  await give(page, measuredObject(1, 0));
  await expect(page.getByRole('button', { name: /^Object 2 196 points/ })).toBeVisible();
  await page.getByRole('button', { name: 'What Object 2 is used for' }).click();
  await page.getByRole('menuitemradio', { name: /^Good part/ }).click();
  const good = page.getByRole('button', { name: /^Object 2 196 points, good part/ });
  await expect(good).toBeVisible();
  await quickly(page);
  await run(page, 'Diagnose');
  await expect(strip(page, 'Diagnosis ready')).toBeVisible(seen);
  await expect(page.getByRole('button', { name: /^Uneven heating, side to side/ })).toBeVisible();
  await expect(
    page.getByText('What the simulation misses of the good part Object 2 is not counted.'),
  ).toBeVisible();
  await expectAccessible(page, 'beside a good part');
  await expect(page.getByText('Saved', { exact: true })).toBeVisible();
  await page.reload();
  await expect(good).toBeVisible();
  await expect(strip(page, 'Diagnosis ready')).toBeVisible();
});

test('a calibration says what the data do not tell, and takes what it fitted along', async ({ page }) => {
  await openObject(page);
  await page.getByRole('radio', { name: 'Calibrate' }).click();
  await page.getByRole('textbox', { name: 'Triangles' }).fill('1500');
  await page.getByRole('textbox', { name: 'Triangles' }).press('Enter');
  await run(page, 'Calibrate');
  await expect(strip(page, 'Calibration ready')).toBeVisible(seen);
  const table = page.getByRole('table');
  for (const name of [
    /^Young/,
    /^Creep/,
    /^Yield/,
    /^Viscosity/,
    /^Mould misplaced in x/,
    /^Mould misplaced in y/,
  ])
    await expect(table.getByRole('row', { name })).toBeVisible();
  await expect(page.getByRole('img', { name: /^Likelihood of Young/ })).toBeVisible();
  await page.getByRole('button', { name: 'Use in the next print' }).click();
  await expect(page.getByRole('button', { name: 'Used in the next print' })).toBeVisible();
  await expectAccessible(page, 'calibrated');
});

test('a run stops at once, and what was there stays', async ({ page }) => {
  await openObject(page);
  await run(page, 'Diagnose');
  await expect(page.getByRole('progressbar')).toBeVisible();
  const start = Date.now();
  await page.keyboard.press('Escape');
  await expect(strip(page, 'Stopped')).toBeVisible({ timeout: 5000 });
  test.info().annotations.push({ type: 'cancelled after', description: `${Date.now() - start} ms` });
  await expect(page.getByRole('img', { name: /^Measured height/ })).toBeVisible();
  await expect(page.getByText('Saved', { exact: true })).toBeVisible();
  await page.reload();
  await expect(page.getByRole('button', { name: /^Object 1 196 points/ })).toBeVisible();
  await expect(strip(page, 'Compared with the settings as they are')).toBeVisible();
});

test('files that lack a third, are strange or in metres are said in words', async ({ page }) => {
  await openRoom(page);
  await expectAccessible(page, 'empty');
  const [mould, setup, measured] = measuredObject();
  await give(page, [mould, setup]);
  await expect(page.getByText('Still missing: measured.csv')).toBeVisible();
  await give(page, [measured]);
  await expect(page.getByText('Still missing')).toBeHidden();
  await expect(strip(page, 'Compared with the settings as they are')).toBeVisible();
  await give(page, [fileOf('picture.tiff', 'x')]);
  await expect(page.getByRole('alert').getByText('Could not open picture.tiff')).toBeVisible();
  await expect(page.getByText('mould.obj, setup.json, measured.csv')).toBeVisible();
  await give(page, measuredObject(0.001));
  await expect(page.getByRole('button', { name: /^Object 2 196 points/ })).toBeVisible();
  await run(page, 'Diagnose');
  await expect(page.getByRole('alert').getByText(/seem to be in metres/)).toBeVisible();
  await expect(page.getByRole('alert').getByText(/convert them to millimetres/)).toBeVisible();
  await page.keyboard.press('Control+z');
  await expect(page.getByRole('button', { name: /^Object 2/ })).toBeHidden();
  await expect(page.getByRole('button', { name: /^Object 1 196 points/ })).toBeVisible();
});

test('a scan is measured, its corners set by hand, and becomes an object', async ({ page }) => {
  await openRoom(page);
  const { scan, picture, pattern } = scannedSheet();
  await give(page, [scan, picture]);
  await expect(page.getByText('Still missing: pattern.')).toBeVisible();
  await give(page, [pattern]);
  await page.getByRole('textbox', { name: 'Point spacing' }).fill('5');
  await page.getByRole('textbox', { name: 'Point spacing' }).press('Enter');
  await page.getByRole('button', { name: /^Flow/ }).click();
  await page.getByRole('textbox', { name: 'Picture size' }).fill('600');
  await page.getByRole('textbox', { name: 'Picture size' }).press('Enter');
  const measure = async () => {
    await page.getByRole('button', { name: 'Measure the scan' }).click();
    await expect(page.getByRole('button', { name: 'Use these points' })).toBeVisible(seen);
  };
  await measure();
  await expect(page.getByText(/^similarity (0\.99|1\.0)/)).toBeVisible();

  await expect(page.getByRole('img', { name: /^Corner .*, found at/ })).toHaveCount(4);
  await page.getByRole('button', { name: 'Set the corners by hand' }).click();
  const corner = (name: string) => page.getByRole('button', { name: new RegExp(`^Corner ${name}`) });
  const image = page.getByRole('img', { name: 'The scan’s picture' });
  const box = await image.boundingBox();
  if (box === null) throw new Error('The picture is not to be seen.');
  // Where the pattern has its marks, as shares of the picture.
  for (const [name, x, y] of [
    ['front left', 0.162, 0.854],
    ['front right', 0.838, 0.854],
    ['back right', 0.838, 0.146],
    ['back left', 0.162, 0.146],
  ] as const) {
    await corner(name).hover();
    await page.mouse.down();
    await page.mouse.move(box.x + x * box.width, box.y + y * box.height, { steps: 4 });
    await page.mouse.up();
  }
  const before = await corner('back left').getAttribute('aria-label');
  await corner('back left').focus();
  await page.keyboard.press('Shift+ArrowRight');
  await expect(corner('back left')).not.toHaveAttribute('aria-label', before ?? '');
  await page.keyboard.press('Control+z');
  await expect(corner('back left')).toHaveAttribute('aria-label', before ?? '');
  await expectAccessible(page, 'corners');
  await measure();
  await expect(page.getByText(/^similarity (0\.99|1\.0)/)).toBeVisible();

  await page.getByRole('button', { name: 'Use these points' }).click();
  await expect(page.getByText('Still missing: mould.obj and setup.json')).toBeVisible();
  const [mould, setup] = measuredObject();
  await give(page, [mould, setup]);
  await expect(page.getByRole('button', { name: /^scan \d+ points/ })).toBeVisible();
});

test('photographs with a phone are measured, and their points become an object', async ({ page }) => {
  await openRoom(page);
  const taken = (name: string) => ({
    ...fileOf(name, ''),
    buffer: readFileSync(new URL(`../tests/jobs/photographs/${name}`, import.meta.url)),
  });
  const photograph = (number: number) => taken(`photo${number}.jpg`);
  await give(page, [photograph(1), photograph(2)]);
  await expect(page.getByText('Still missing: pattern.')).toBeVisible();
  await give(page, [photograph(3), taken('pattern.json')]);
  await expect(page.getByRole('img', { name: 'photo3.jpg' })).toBeVisible();
  await page.getByRole('textbox', { name: 'Height of the board' }).fill('12');
  await page.getByRole('textbox', { name: 'Height of the board' }).press('Enter');
  await page.getByRole('button', { name: 'Measure the photographs' }).click();
  await expect(page.getByRole('button', { name: 'Use these points' })).toBeVisible(seen);
  await expect(page.getByText(/^\d\d of 25 marks$/)).toBeVisible();
  await expect(page.getByText('found in one photograph only')).toBeVisible();
  await expectAccessible(page, 'photographs');
  await page.getByRole('button', { name: 'Use these points' }).click();
  await expect(page.getByText('Still missing: mould.obj and setup.json')).toBeVisible();
});

test('a virtual object with a fault of one’s choice', async ({ page }) => {
  await openRoom(page);
  await page.getByRole('button', { name: 'Try a virtual object' }).click();
  const dialog = page.getByRole('dialog', { name: 'Make a virtual object' });
  await expect(dialog.getByRole('textbox', { name: 'Colder towards the right' })).toHaveValue('0.30');
  await dialog.getByRole('combobox', { name: 'Mould' }).selectOption('Pyramid');
  // Help lies over the dialog: in the browser's top layer, like the dialog itself.
  await dialog.getByText('Colder towards the right').hover();
  await expect(page.locator('.tip:popover-open')).toBeVisible();
  await dialog.getByRole('textbox', { name: 'Points', exact: true }).fill('300');
  await dialog.getByRole('textbox', { name: 'Points', exact: true }).press('Tab');
  await expectAccessible(page, 'virtual object');
  await dialog.getByRole('button', { name: 'Make the virtual object' }).click();
  await expect(page.getByRole('button', { name: /^virtual pyramid 3\d\d points/ })).toBeVisible(seen);
  await expect(strip(page, 'Compared with the settings as they are')).toBeVisible(seen);
});
