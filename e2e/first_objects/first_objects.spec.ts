// SPDX-License-Identifier: GPL-3.0-or-later
// A maker's first own object in every craft: how many actions, how many seconds. The way is the one that the page offers first: the
// filled button, else what is written on the page.
import type { Locator, Page } from '@playwright/test';
import { readFileSync } from 'node:fs';
import { position, setSpeed, square, startButton } from '../machine_room';
import {
  backend,
  expect as expectSoon,
  goToRoom,
  openPage,
  openSampleIn,
  readStl,
  strip,
  test as base,
} from '../page';
import type { ActionCount } from './actions';
import { countActions } from './actions';
import type { OwnFile } from './own_files';
import { ball, measuredPyramid, paintedHill, smallBall, wrongFile } from './own_files';
import { recordRow } from './record_row';

const test = base.extend<{ counter: ActionCount }>({
  counter: async ({ page }, use) => {
    await use(await countActions(page));
  },
});
test.skip(backend !== 'wasm', 'counted once: the worker serves the same page');
test.setTimeout(900_000); // machines take their time, practice or not
test.use({ actionTimeout: 120_000 });
/** What is measured is how long it takes: a busy machine is waited for. */
const expect = expectSoon.configure({ timeout: 300_000 });

const ready = 'Preview up to date';
const button = (page: Page, name: string | RegExp) =>
  page.getByRole('button', typeof name === 'string' ? { name, exact: true } : { name });

/** The press that opens the file chooser, and what is chosen in it. */
async function chooseFiles(page: Page, opener: Locator, files: readonly OwnFile[]): Promise<void> {
  const choosing = page.waitForEvent('filechooser');
  await opener.click();
  await (await choosing).setFiles([...files]);
}

async function openOwnModel(
  page: Page,
  craft: 'Relief' | 'Thermoform' | 'Zippable',
  files: readonly OwnFile[] = [ball],
): Promise<void> {
  await chooseFiles(page, button(page, 'Open a file'), files);
  await page.getByRole('dialog').getByRole('button', { name: craft }).click();
  await expect(strip(page, ready)).toBeVisible();
}

async function save(page: Page, press: () => Promise<void>): Promise<Buffer> {
  const waiting = page.waitForEvent('download', { timeout: 300_000 });
  await press();
  return readFileSync(await (await waiting).path());
}

test('first minute', async ({ page, counter }) => {
  await openPage(page);
  await counter.begin();
  await page.locator('.gallery button', { hasText: 'Bust' }).click();
  await expect(strip(page, ready)).toBeVisible();
  await recordRow('first_minute', counter);
});

test('relief', async ({ page, counter }) => {
  await openPage(page);
  await counter.begin();
  await openOwnModel(page, 'Relief');
  await button(page, 'Solve at full detail').click();
  await expect(strip(page, 'Relief ready')).toBeVisible();
  const stl = await save(page, () => button(page, 'Export STL').click());
  expect(readStl(stl).closed).toBe(true);
  await recordRow('relief', counter);
});

test('shell', async ({ page, counter }) => {
  await openPage(page);
  await counter.begin();
  await openOwnModel(page, 'Thermoform', paintedHill());
  await button(page, 'Form at full detail').click();
  await expect(strip(page, 'Sheet formed')).toBeVisible();
  const print = await save(page, () => button(page, 'Export print').click());
  expect(print.toString('latin1', 0, 5)).toBe('%PDF-');
  await button(page, 'Export something else').click();
  const mould = await save(page, () => page.getByRole('menuitem', { name: /^Mould, STL/ }).click());
  expect(readStl(mould).closed).toBe(true);
  await recordRow('shell', counter);
});

async function makeRibbon(page: Page): Promise<void> {
  await button(page, 'Make the ribbon').click();
  await expect(strip(page, 'Ribbon unfolded')).toBeVisible();
}

test('zippable', async ({ page, counter }) => {
  await openPage(page);
  await counter.begin();
  await openOwnModel(page, 'Zippable');
  await makeRibbon(page);
  await page.getByRole('radio', { name: 'Sheets to cut' }).click();
  await expect(page.getByRole('img', { name: /^\d+ pieces? on \d+ sheets? of / })).toBeVisible();
  const plan = await save(page, () => button(page, 'Export plan, SVG').click());
  expect(plan.toString()).toContain('id="cut"');
  await recordRow('zippable', counter);
});

test('zipping', async ({ page, counter }) => {
  await openSampleIn(page, 'Zippable', 'Star');
  await makeRibbon(page);
  await counter.begin();
  await page.getByRole('radio', { name: 'Zipped' }).click();
  await button(page, 'Will it zip? Simulate cloth').click();
  await expect(page.getByText(/^It (zips|does not zip)/)).toBeVisible();
  await recordRow('zipping', counter);
});

test('drawn parts', async ({ page, counter }) => {
  await openPage(page);
  await counter.begin();
  await openOwnModel(page, 'Zippable');
  await button(page, 'Draw the parts').click();
  const model = await page.locator('.zippable-model').boundingBox();
  if (model === null) throw new Error('The model is not to be seen.');
  await page.getByRole('radio', { name: 'Ring' }).click();
  await page.waitForTimeout(3000); // a person looks where to draw
  const y = model.y + 0.5 * model.height;
  await page.mouse.move(model.x + 0.05 * model.width, y);
  await page.mouse.down();
  await page.mouse.move(model.x + 0.95 * model.width, y, { steps: 10 });
  await page.mouse.up();
  await expect(page.getByText('Drawn by hand: 1 border')).toBeVisible();
  await expect(page.getByRole('list', { name: 'Parts' }).getByRole('button')).toHaveCount(2);
  await expect(strip(page, ready)).toBeVisible();
  await recordRow('drawn_parts', counter);
});

test('evidence', async ({ page, counter }) => {
  const files = await measuredPyramid(page);
  await page.getByRole('link', { name: 'Formwright, start' }).click();
  await counter.begin();
  await chooseFiles(page, button(page, 'Open a file'), files);
  await expect(strip(page, 'Compared with the settings as they are')).toBeVisible();
  // As the tutorial does: one cause at a time, and coarse sheets, are much quicker.
  await page.getByRole('switch', { name: 'Two causes at once' }).click();
  await page.getByRole('switch', { name: 'Propose a measurement' }).click();
  await page.getByRole('textbox', { name: 'Triangles' }).click();
  await page.keyboard.press('Control+a');
  await page.keyboard.type('500');
  await page.keyboard.press('Enter');
  await page.locator('.inspector-foot').getByRole('button', { name: 'Diagnose', exact: true }).click();
  await expect(strip(page, 'Diagnosis ready')).toBeVisible({ timeout: 600_000 });
  await expect(button(page, /^Uneven heating, side to side/)).toBeVisible();
  await recordRow('evidence', counter);
});

/** Not counted: so that the story is short, the laser is quicker than it would be. */
async function setLaserSpeeds(page: Page): Promise<void> {
  await goToRoom(page, 'Machines');
  await page.getByLabel('Model or project file').setInputFiles(square);
  await expect(strip(page, 'Job ready')).toBeVisible();
  for (const layer of ['Cut', 'Mark', 'Engrave']) await setSpeed(page, layer, '150');
  await goToRoom(page, 'Zippable');
}

/** At its own speed a practice machine takes as long as a real one: jobs run to their end in `npm run actions` and `make test-all` only. */
const inFull = process.env['FORMWRIGHT_LONG_TESTS'] === 'ON';

test('laser', async ({ page, counter }) => {
  await openPage(page);
  await openOwnModel(page, 'Zippable', [smallBall]);
  await makeRibbon(page);
  await setLaserSpeeds(page);
  await counter.begin();
  await page.getByRole('radio', { name: 'Sheets to cut' }).click();
  await expect(page.getByRole('img', { name: /1 sheet of 400 × 400/ })).toBeVisible();
  await button(page, /Send to a machine/).click();
  await expect(strip(page, 'Job ready')).toBeVisible();
  await button(page, 'Practise the job').click();
  await page.getByRole('dialog').getByRole('button', { name: 'Home', exact: true }).click();
  await button(page, 'Start with the laser on').click();
  await expect(page.locator('.state-chip')).toHaveText('Working');
  if (inFull) await expect(strip(page, 'ball is done')).toBeVisible();
  await recordRow('laser', counter); // nothing more is asked of a person until it is done
});

/** Not counted: a medal that a mill carves in a minute. */
async function setReliefSize(page: Page, width_mm: string, thickness_mm: string): Promise<void> {
  for (const [name, value] of [
    ['Width', width_mm],
    ['Thickness', thickness_mm],
  ] as const) {
    await page.getByRole('textbox', { name, exact: true }).fill(value);
    await page.getByRole('textbox', { name, exact: true }).press('Enter');
  }
  await expect(strip(page, ready)).toBeVisible();
}

test('mill', async ({ page, counter }) => {
  test.skip(!inFull, 'a minute of milling, as run_a_machine.spec.ts has it, too');
  await openPage(page);
  await openOwnModel(page, 'Relief');
  await setReliefSize(page, '10', '1');
  await button(page, 'Solve at full detail').click();
  await expect(strip(page, 'Relief ready')).toBeVisible();
  await counter.begin();
  await button(page, 'Send to a machine').click();
  await expect(strip(page, 'Job ready')).toBeVisible();
  await button(page, 'Practise the job').click();
  await page.getByRole('dialog').getByRole('button', { name: 'Home', exact: true }).click();
  await expect(page.locator('.state-chip')).toHaveText('Ready');
  // Held down, until the tool has come down to the stock: the job rises above it.
  await page.getByRole('button', { name: 'Move the tool down' }).hover();
  await page.mouse.down();
  const height = position(page).locator('div', { hasText: 'Z' }).locator('b');
  await expect(height).toHaveText(/^−[1-9]\d\.\d\d$/);
  await page.mouse.up();
  await expect(page.locator('.state-chip')).toHaveText('Ready');
  for (const done of [/^ball, roughing is done$/, /^ball, finishing is done$/]) {
    await startButton(page).click();
    await page.getByRole('dialog').getByRole('button', { name: 'Set z here and start the spindle' }).click();
    await expect(strip(page, done)).toBeVisible();
  }
  await recordRow('mill', counter);
});

test('wrong file', async ({ page, counter }) => {
  await openPage(page);
  await counter.begin();
  await chooseFiles(page, button(page, 'Open a file'), [wrongFile]);
  await page.getByRole('dialog').getByRole('button', { name: 'Relief' }).click();
  await expect(page.getByRole('alert').getByText('Could not open notes.obj')).toBeVisible();
  await chooseFiles(page, button(page, 'Choose another file'), [ball]);
  await expect(strip(page, ready)).toBeVisible();
  await recordRow('wrong_file', counter);
});

test('keyboard', async ({ page, counter }) => {
  await openPage(page);
  await counter.begin();
  await page.keyboard.press('?');
  await expect(page.getByRole('dialog', { name: 'All keys' })).toBeVisible();
  await page.keyboard.press('Escape');
  await expect(page.getByRole('dialog')).toBeHidden();
  const choosing = page.waitForEvent('filechooser');
  await page.keyboard.press('Control+o');
  await (await choosing).setFiles(ball);
  await expect(page.getByRole('dialog').getByRole('button', { name: 'Relief' })).toBeFocused();
  await page.keyboard.press('Enter');
  await expect(strip(page, ready)).toBeVisible();
  await page.keyboard.press('Control+Enter');
  await expect(strip(page, 'Relief ready')).toBeVisible();
  const stl = await save(page, () => page.keyboard.press('Control+e'));
  expect(readStl(stl).closed).toBe(true);
  await recordRow('keyboard', counter);
});

test.describe('on a phone', () => {
  test.use({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  test('relief', async ({ page, counter }) => {
    await openPage(page);
    await counter.begin();
    const choosing = page.waitForEvent('filechooser');
    await button(page, 'Open a file').tap();
    await (await choosing).setFiles(ball);
    await page.getByRole('dialog').getByRole('button', { name: 'Relief' }).tap();
    await expect(strip(page, ready)).toBeVisible();
    await button(page, 'Solve at full detail').tap();
    await expect(strip(page, 'Relief ready')).toBeVisible();
    const stl = await save(page, () => button(page, 'Export STL').tap());
    expect(readStl(stl).closed).toBe(true);
    await recordRow('phone', counter);
  });
});
