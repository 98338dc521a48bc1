// SPDX-License-Identifier: GPL-3.0-or-later
import type { Page } from '@playwright/test';
import { readFileSync } from 'node:fs';
import {
  backend,
  expect,
  expectAccessible,
  fileOf,
  openPage,
  openSample,
  solve,
  strip,
  test,
  testEveryLook,
} from './page';

test.skip(
  backend !== 'wasm',
  'the mock makes reliefs only; the worker’s own machines: machines_of_the_worker.spec.ts',
);

/** A square with a hole, and a mark: 40 by 40 mm. */
const square = fileOf(
  'square.svg',
  `<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="40mm" viewBox="0 0 40 40">
  <g id="cut" fill="none" stroke="#f00"><path d="M1 1H39V39H1Z"/><circle cx="20" cy="20" r="6"/></g>
  <g id="mark" fill="none" stroke="#00f"><path d="M5 5H15"/></g></svg>`,
);

const chip = (page: Page) => page.locator('.state-chip');
const position = (page: Page) => page.getByRole('group', { name: /^Position of the head/ });
const button = (page: Page, name: string) => page.getByRole('button', { name, exact: true });
/** Disabled buttons say why in their name. */
const startButton = (page: Page) => page.locator('.inspector-foot').getByRole('button', { name: /^Start/ });
const dialog = (page: Page) => page.getByRole('dialog');

async function openRoom(page: Page): Promise<void> {
  await openPage(page);
  await page.getByRole('link', { name: 'Machines', exact: true }).click();
  await expect(button(page, 'Practise without a machine')).toBeVisible();
}

async function openDrawing(page: Page, file = square): Promise<void> {
  await openRoom(page);
  await page.getByLabel('Model or project file').setInputFiles(file);
  await expect(strip(page, 'Job ready')).toBeVisible();
}

/** Nothing is done before the question is answered, and the focus stands on Cancel. */
async function confirm(page: Page, title: RegExp, action: string, says: RegExp): Promise<void> {
  await expect(dialog(page).getByRole('heading', { name: title })).toBeVisible();
  await expect(dialog(page).getByText(says)).toBeVisible();
  await expect(dialog(page).getByRole('button', { name: 'Cancel' })).toBeFocused();
  await dialog(page).getByRole('button', { name: action, exact: true }).click();
}

async function practise(page: Page): Promise<void> {
  await button(page, 'Practise without a machine').click();
  await expect(chip(page)).toHaveText('Locked');
  await expect(position(page).getByText('unknown')).toHaveCount(2);
}

async function homeIt(page: Page): Promise<void> {
  await page.locator('.machine-buttons').getByRole('button', { name: 'Home' }).click();
  await confirm(page, /^Home the machine/, 'Home', /moves to its switches/);
  await expect(chip(page)).toHaveText('Ready');
  await expect(position(page).getByText('unknown')).toHaveCount(0);
}

const coordinate = async (page: Page, axis: 'X' | 'Y'): Promise<number> => {
  const text = await position(page).locator('div', { hasText: axis }).locator('b').textContent();
  return Number((text ?? '').replace('−', '-'));
};

/** Holds the key until the head has gone so far, and sees that it stops when it is let go. */
async function holdJog(page: Page, name: string, axis: 'X' | 'Y', beyond_mm: number): Promise<void> {
  await page.getByRole('button', { name: `Move ${name}` }).hover();
  await page.mouse.down();
  await expect.poll(() => coordinate(page, axis), { timeout: 30_000 }).toBeGreaterThan(beyond_mm);
  await page.mouse.up();
  await expect(chip(page)).toHaveText('Ready');
  const rested = await coordinate(page, axis);
  await page.waitForTimeout(400);
  expect(await coordinate(page, axis)).toBeCloseTo(rested, 1);
}

async function setOrigin(page: Page): Promise<void> {
  await button(page, 'Set origin here').click();
  await expect.poll(() => coordinate(page, 'X')).toBeCloseTo(0, 1);
  await expect.poll(() => coordinate(page, 'Y')).toBeCloseTo(0, 1);
}

async function makeReady(page: Page): Promise<void> {
  await practise(page);
  await homeIt(page);
}

async function startIt(page: Page): Promise<void> {
  await startButton(page).click();
  await confirm(page, /^Start /, 'Start with the laser on', /laser turns on/);
  await expect(chip(page)).toHaveText('Working');
}

async function setSpeed(page: Page, group: string, mm_per_s: string): Promise<void> {
  await page.getByRole('button', { name: new RegExp(`^${group} \\d+$`) }).click();
  const field = page
    .getByRole('region', { name: group, exact: true })
    .getByRole('textbox', { name: 'Speed' });
  await field.fill(mm_per_s);
  await field.press('Enter');
}

test('from the sample star to a finished laser job', async ({ page }) => {
  test.setTimeout(420_000); // the laser takes its two minutes, practice or not
  await openPage(page);
  await page.getByRole('link', { name: 'Zippable', exact: true }).click();
  await page.locator('.gallery button', { hasText: 'Star' }).click();
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await page.getByRole('button', { name: 'Make the ribbon', exact: true }).click();
  await expect(strip(page, 'Ribbon unfolded')).toBeVisible({ timeout: 150_000 });
  await page.getByRole('radio', { name: 'Sheets to cut' }).click();
  await page.getByRole('textbox', { name: 'Sheet width' }).fill('300');
  await page.getByRole('textbox', { name: 'Sheet width' }).press('Enter');
  await expect(page.getByRole('img', { name: / of 300 × 300\smm; / })).toBeVisible();
  const send = page.getByRole('button', { name: /Send to a machine/ });
  await send.click();
  const first = page.getByRole('menuitem', { name: 'Sheet 1' });
  if (await first.isVisible().catch(() => false)) await first.click();
  await expect(strip(page, 'Job ready')).toBeVisible({ timeout: 60_000 });
  await expect(page.getByRole('img', { name: /^Bed of 400 × 400/ })).toBeVisible();

  // Quick, so that the story is short.
  await setSpeed(page, 'Cut', '150');
  await setSpeed(page, 'Mark', '150');
  await expect(strip(page, 'Job ready')).toBeVisible();
  await expect(startButton(page)).toHaveAttribute('aria-disabled', 'true');
  await makeReady(page);
  await holdJog(page, 'right', 'X', 10);
  await holdJog(page, 'back', 'Y', 10);
  await setOrigin(page);
  await button(page, 'Frame').click();
  await confirm(page, /^Frame the job/, 'Frame', /laser stays off/);
  await expect(chip(page)).toHaveText('Moving');
  await expect(chip(page)).toHaveText('Ready', { timeout: 60_000 });
  await startIt(page);
  await expect(page.getByRole('progressbar')).toBeVisible();
  await expect(
    page
      .getByRole('contentinfo')
      .locator('strong')
      .getByText(/ is done$/),
  ).toBeVisible({ timeout: 300_000 });
  await page.getByRole('radio', { name: 'Console' }).click();
  await page.getByText('1 job so far').click();
  await expect(page.getByText(/done after /)).toBeVisible();
});

test('a drawing to a finished job by keyboard alone', async ({ page }) => {
  await openDrawing(page);
  const press = async (name: string) => {
    await button(page, name).focus();
    await page.keyboard.press('Enter');
  };
  const bed = page.getByRole('img', { name: /^Bed of/ });
  await bed.focus();
  await page.keyboard.press('Shift+ArrowRight');
  await page.keyboard.press('ArrowUp');
  await expect(bed).toHaveAccessibleName(/job from 1\d\.\d+, 1\.\d+ to/);
  await page.keyboard.press('Control+z');
  await page.keyboard.press('Control+z');
  await expect(bed).toHaveAccessibleName(/job from 0\.\d+, 0\.\d+ to/);
  await press('Practise without a machine');
  await expect(chip(page)).toHaveText('Locked');
  await page.locator('.machine-buttons').getByRole('button', { name: 'Home' }).focus();
  await page.keyboard.press('Enter');
  await expect(dialog(page).getByRole('button', { name: 'Cancel' })).toBeFocused();
  await page.keyboard.press('Tab');
  await page.keyboard.press('Enter');
  await expect(chip(page)).toHaveText('Ready');
  for (const [name, key, axis] of [
    ['Move right', 'ArrowRight', 'X'],
    ['Move back', 'ArrowUp', 'Y'],
  ] as const) {
    await page.getByRole('button', { name }).focus();
    await page.keyboard.press(`Shift+${key}`);
    await page.keyboard.press(key);
    await expect.poll(() => coordinate(page, axis)).toBeCloseTo(11, 1);
  }
  await press('Set origin here');
  await expect.poll(() => coordinate(page, 'X')).toBeCloseTo(0, 1);
  await page.keyboard.press('Control+Enter');
  await expect(dialog(page).getByRole('button', { name: 'Cancel' })).toBeFocused();
  await page.keyboard.press('Tab');
  await page.keyboard.press('Enter');
  await expect(chip(page)).toHaveText('Working');
  await page.keyboard.press('Escape'); // holds
  await expect(chip(page)).toHaveText('Held');
  await press('Go on');
  await expect(dialog(page).getByRole('button', { name: 'Cancel' })).toBeFocused();
  await page.keyboard.press('Tab');
  await page.keyboard.press('Enter');
  await expect(chip(page)).toHaveText('Working');
  await expect(strip(page, 'square is done')).toBeVisible({ timeout: 120_000 });
});

test('stopped in the middle: the position is unknown, and the rest is cut after homing', async ({ page }) => {
  await openDrawing(page);
  await makeReady(page);
  await startIt(page);
  await expect(page.getByRole('progressbar')).not.toHaveAttribute('aria-valuenow', /^[0-9]$/);
  await button(page, 'Stop').click();
  await expect(
    page
      .getByRole('contentinfo')
      .locator('strong')
      .getByText(/^Job stopped at \d+ %$/),
  ).toBeVisible();
  await expect(position(page).getByText('unknown')).toHaveCount(2);
  await expect(page.getByRole('button', { name: /^Cut the rest/ })).toHaveAttribute('aria-disabled', 'true');
  await expect(startButton(page)).toHaveAttribute('aria-disabled', 'true');
  await homeIt(page);
  await page.getByRole('button', { name: /^Cut the rest/ }).click();
  await confirm(page, /^Cut the rest/, 'Continue with the laser on', /begins at line \d+/);
  await expect(chip(page)).toHaveText('Working');
  await expect(strip(page, 'square is done')).toBeVisible({ timeout: 120_000 });
});

test('Stop on the keyboard and in another room', async ({ page }) => {
  await openDrawing(page);
  await makeReady(page);
  await startIt(page);
  await page.getByRole('link', { name: 'Relief', exact: true }).click();
  const bar = page.getByRole('complementary', { name: 'The machine' });
  await expect(bar.getByText(/^Working on square/)).toBeVisible();
  await page.keyboard.press('Control+.');
  await expect(bar).toBeHidden();
  await page.getByRole('link', { name: 'Machines', exact: true }).click();
  await expect(
    page
      .getByRole('contentinfo')
      .locator('strong')
      .getByText(/^Job stopped at/),
  ).toBeVisible();
});

test('what a tab controls no other tab does', async ({ page, context }) => {
  await openRoom(page);
  await practise(page);
  const second = await context.newPage();
  await openRoom(second);
  await button(second, 'Practise without a machine').click();
  await expect(
    second.getByRole('alert').getByText(/^Another tab of this page controls a machine/),
  ).toBeVisible();
  await button(page, 'Disconnect').click();
  await expect(chip(page)).toHaveText('Offline');
  await button(second, 'Practise without a machine').click();
  await expect(chip(second)).toHaveText('Locked');
  await second.close();
});

test('wrong files are said in words and the work stays', async ({ page }) => {
  await openDrawing(page);
  const input = page.getByLabel('Model or project file');
  await input.setInputFiles(fileOf('words.txt', 'hello'));
  await expect(page.getByRole('alert').getByText('Could not open words.txt')).toBeVisible();
  await expect(page.getByRole('alert').getByText(/^Machines take drawings \(\.svg\), jobs/)).toBeVisible();
  await expect(strip(page, 'Job ready')).toBeVisible();
  await input.setInputFiles(fileOf('notes.svg', 'this is no drawing'));
  await expect(page.getByRole('alert').getByText('Could not read notes.svg')).toBeVisible();
  await input.setInputFiles(fileOf('notes.nc', 'no moves in here'));
  await expect(page.getByRole('alert').getByText('Could not read notes.nc')).toBeVisible();
  await input.setInputFiles(fileOf('line.nc', 'G21 G90\nM4 S500\nG1 X50 Y0 F3000\nG1 X50 Y20\nM5\n'));
  await expect(page.getByRole('img', { name: /job from 0\.0+, 0\.0+ to 50\.0+, 20\.0+\smm/ })).toBeVisible();
});

test('a job that does not fit is said before anything moves', async ({ page }) => {
  await openDrawing(page);
  await page.getByRole('textbox', { name: 'Position in x' }).fill('390');
  await page.getByRole('textbox', { name: 'Position in x' }).press('Enter');
  await expect(strip(page, 'The job does not fit')).toBeVisible();
  await practise(page);
  await homeIt(page);
  const start = startButton(page);
  await expect(start).toHaveAttribute('aria-disabled', 'true');
  await start.click({ force: true });
  await expect(dialog(page)).toBeHidden();
});

test('a profile goes out as a file and comes back', async ({ page }) => {
  await openRoom(page);
  const menu = page.locator('.profile-button');
  await menu.click();
  await page.getByRole('menuitem', { name: 'Add a machine' }).click();
  await dialog(page).getByLabel('Name').fill('Workshop laser');
  await dialog(page).getByLabel('Bed width, mm').fill('600');
  await dialog(page).getByRole('button', { name: 'Add', exact: true }).click();
  await expect(menu).toHaveText('Workshop laser');
  await menu.click();
  const waiting = page.waitForEvent('download');
  await page.getByRole('menuitem', { name: 'Export its profile' }).click();
  const path = await (await waiting).path();
  const text = readFileSync(path, 'utf8');
  expect(JSON.parse(text)).toMatchObject({ name: 'Workshop laser', parameters: { bed_x_mm: 600 } });
  await menu.click();
  await page.getByRole('menuitem', { name: 'Remove this machine' }).click();
  await expect(menu).toHaveText('Practice laser');
  const file = page.getByLabel('Machine profile');
  await file.setInputFiles(fileOf('broken.json', '{"format":"formwright-machine","version":1}'));
  await expect(page.getByRole('alert').getByText('Could not read broken.json')).toBeVisible();
  await file.setInputFiles(fileOf('workshop.json', text));
  await expect(menu).toHaveText('Workshop laser');
  await expect(page.getByRole('img', { name: /bed/i })).toBeVisible();
  await page.reload();
  await expect(menu).toHaveText('Workshop laser');
});

const showsTest = (page: Page) => page.getByRole('region', { name: 'What the test shows' });

test('material is tested, and what the tests show is set and kept', async ({ page }) => {
  test.setTimeout(420_000); // a small test is run to its end
  await openDrawing(page);
  await button(page, 'Save as a material').click();
  await dialog(page).getByLabel('Name').fill('Felt');
  await dialog(page).getByRole('button', { name: 'Keep', exact: true }).click();
  await expect(page.getByLabel('Preset').locator('option:checked')).toHaveText('Felt');

  // Four squares, quick, run like any job.
  await button(page, 'Test material').click();
  await expect(page.getByRole('combobox', { name: 'Best square' }).locator('option')).toHaveCount(26);
  for (const [name, value] of [
    ['Number of powers', '2'],
    ['Number of speeds', '2'],
    ['Lowest speed', '50'],
    ['Highest speed', '100'],
  ] as const) {
    await page.getByRole('textbox', { name, exact: true }).fill(value);
    await page.getByRole('textbox', { name, exact: true }).press('Enter');
  }
  await expect(page.getByRole('combobox', { name: 'Best square' }).locator('option')).toHaveCount(5);
  await expect(strip(page, 'Job ready')).toBeVisible();
  await makeReady(page);
  await button(page, 'Frame').click();
  await confirm(page, /^Frame the job/, 'Frame', /laser stays off/);
  await expect(chip(page)).toHaveText('Moving');
  await expect(chip(page)).toHaveText('Ready', { timeout: 60_000 });
  await startIt(page);
  await expect(strip(page, 'Material test is done')).toBeVisible({ timeout: 240_000 });

  // A click on a square chooses it, and so do the keys.
  const bed = page.getByRole('img', { name: /^Bed of 400 × 400/ });
  const box = await bed.boundingBox();
  if (box === null) throw new Error('No bed.');
  const scale = Math.min((box.width - 62) / 400, (box.height - 44) / 400);
  const left = box.x + 44 + (box.width - 62 - 400 * scale) / 2;
  const low = box.y + box.height - 30 - (box.height - 44 - 400 * scale) / 2;
  const best = page.getByRole('combobox', { name: 'Best square' });
  await best.selectOption('R1C1');
  const [x, y] = [32, 14]; // about the first square's middle; its place is said in the report
  await page.mouse.click(left + x * scale, low - y * scale);
  await expect(best).toHaveValue('R1C1');
  await best.focus();
  await page.keyboard.press('ArrowDown');
  await expect(best).toHaveValue('R1C2');
  await showsTest(page).getByRole('button', { name: 'Use for cutting' }).click();
  await expect(page.getByText('100 % at 50.0 mm/s is set for cutting, and kept with Felt.')).toBeVisible();
  await expect(page.getByLabel('Preset').locator('option:checked')).toHaveText('Felt');
  await expect(page.getByRole('region', { name: 'Layers, in order' })).toContainText(
    /Cut, 1 part100\s%, 50\.0\smm\/s/,
  );
});

test('what the kerf’s scale says becomes the kerf', async ({ page }) => {
  await openDrawing(page);
  await button(page, 'Test material').click();
  await page.getByRole('combobox', { name: 'Test', exact: true }).selectOption('kerf');
  await page.getByRole('textbox', { name: 'Kerf read from the scale' }).fill('0.2');
  await page.getByRole('textbox', { name: 'Kerf read from the scale' }).press('Enter');
  await button(page, 'Use as the kerf').click();
  await expect(strip(page, 'Job ready')).toBeVisible();
  await page.getByRole('button', { name: /^Cutting \d+$/ }).click();
  await expect(page.getByRole('textbox', { name: 'Kerf', exact: true })).toHaveValue(/^0\.20+$/);
});

test('a relief goes to a mill: its job, its way in space, its first lines', async ({ page }) => {
  test.setTimeout(420_000);
  await openSample(page);
  await page.getByRole('textbox', { name: 'Width', exact: true }).fill('40');
  await page.getByRole('textbox', { name: 'Width', exact: true }).press('Enter');
  await solve(page);
  await button(page, 'Send to a machine').click();
  await expect(page.locator('.profile-button')).toHaveText('Practice mill');
  await expect(page.getByRole('textbox', { name: 'Width', exact: true })).toHaveValue('40');
  await expect(page.getByRole('textbox', { name: 'Depth', exact: true })).toHaveValue('5.0');
  await expect(strip(page, 'No job yet')).toBeVisible();
  await button(page, 'Make the job').click();
  await expect(strip(page, 'Job ready')).toBeVisible({ timeout: 150_000 });
  const figures = page.getByRole('region', { name: 'What is carved' });
  await expect(figures).toContainText('Mean deviation');
  await expect(figures).toContainText(/Size40\.0 × 40\.0 × 5\.00\smm/);
  await expect(page.getByRole('img', { name: /^Bed of 300 × 200/ })).toBeVisible();

  await page.getByRole('radio', { name: '3D' }).click();
  const view = page.getByRole('application', { name: 'Tool path' });
  await view.focus();
  await page.keyboard.press('ArrowLeft');
  await page.getByLabel('Time in the job').focus();
  await page.keyboard.press('Home');
  await page.keyboard.press('PageUp');
  await expect(page.locator('.path-view .fw-marker')).toBeVisible();

  await button(page, 'Practise without a machine').click();
  await expect(chip(page)).toHaveText('Locked');
  await page.locator('.machine-buttons').getByRole('button', { name: 'Home' }).click();
  await confirm(page, /^Home the machine/, 'Home', /moves to its switches/);
  await expect(chip(page)).toHaveText('Ready');
  // The tool has no room above it at its switches: from there the job would leave the machine's reach.
  await page.getByRole('button', { name: 'Move the tool down' }).focus();
  await page.keyboard.press('Shift+PageDown');
  await expect(chip(page)).toHaveText('Moving');
  await expect(chip(page)).toHaveText('Ready');
  await button(page, 'Set z here').click();
  // Two tools are two jobs, with z set between them.
  const jobs = page.getByRole('region', { name: 'Jobs, in order' });
  await jobs.getByRole('button', { name: 'Run this next' }).click();
  await expect(jobs).toContainText('next, once z is set');
  await expect(startButton(page)).toHaveAttribute('aria-disabled', 'true');
  await jobs.getByRole('button', { name: 'Run this next' }).click();
  await button(page, 'Set z here').click();
  // Nothing is chosen in advance, and nothing starts before somebody has said where z is 0.
  await startButton(page).click();
  const withSpindle = dialog(page).getByRole('button', { name: /^Start with the spindle on/ });
  await expect(dialog(page).getByText(/spindle turns/)).toBeVisible();
  await expect(dialog(page).getByRole('button', { name: 'Cancel' })).toBeFocused();
  await expect(withSpindle).toHaveAttribute('aria-disabled', 'true');
  await expect(dialog(page).getByRole('radio', { checked: true })).toHaveCount(0);
  await withSpindle.click({ force: true });
  await expect(chip(page)).toHaveText('Ready');
  await dialog(page)
    .getByRole('radio', { name: /^Keep z 0 at −1\d\.\d\d\smm in machine coordinates \(set at / })
    .check();
  await dialog(page)
    .getByRole('radio', { name: /^Set z to the stock’s top here/ })
    .check();
  await expect(dialog(page).getByRole('heading', { name: /^Start .*, roughing/ })).toBeVisible();
  await withSpindle.click();
  await expect(chip(page)).toHaveText('Working');
  await button(page, 'Stop').click();
  await expect(
    page
      .getByRole('contentinfo')
      .locator('strong')
      .getByText(/^Job stopped at/),
  ).toBeVisible();

  // Another depth is another job: the old one cannot be started.
  await page.getByRole('textbox', { name: 'Depth', exact: true }).fill('4');
  await page.getByRole('textbox', { name: 'Depth', exact: true }).press('Enter');
  await expect(button(page, 'Make the job')).toBeVisible();
  await expect(startButton(page)).toHaveAttribute('aria-disabled', 'true');

  // A drawing is no work for a mill: not while it is connected, else a laser is chosen.
  const input = page.getByLabel('Model or project file');
  await input.setInputFiles(square);
  await expect(
    page.getByRole('alert').getByText(/^Drawings are for lasers: disconnect the mill/),
  ).toBeVisible();
  await button(page, 'Disconnect').click();
  await input.setInputFiles(square);
  await expect(page.locator('.profile-button')).toHaveText('Practice laser');
  await expect(strip(page, 'Job ready')).toBeVisible();
});

testEveryLook('axe finds nothing serious in the room', async (page) => {
  await openRoom(page);
  await expectAccessible(page, 'empty');
  await page.getByLabel('Model or project file').setInputFiles(square);
  await expect(strip(page, 'Job ready')).toBeVisible();
  await expectAccessible(page, 'drawing');
  await practise(page);
  await expectAccessible(page, 'locked');
  await page.locator('.machine-buttons').getByRole('button', { name: 'Home' }).click();
  await expectAccessible(page, 'question');
  await dialog(page).getByRole('button', { name: 'Home', exact: true }).click();
  await expect(chip(page)).toHaveText('Ready');
  await expectAccessible(page, 'ready');
  await page.getByRole('radio', { name: '3D' }).click();
  await expectAccessible(page, 'in space');
  await page.getByRole('radio', { name: 'Console' }).click();
  await expectAccessible(page, 'console');
  await page.getByRole('radio', { name: 'Bed' }).click();
  await button(page, 'Test material').click();
  await expect(showsTest(page)).toBeVisible();
  await expectAccessible(page, 'test');
});
