// SPDX-License-Identifier: GPL-3.0-or-later
// A job from its design to its end: laser and mill, stopped, held and continued.
import {
  square,
  chip,
  position,
  button,
  startButton,
  dialog,
  openDrawing,
  confirm,
  homeIt,
  coordinate,
  holdJog,
  setOrigin,
  makeMillReady,
  makeReady,
  startIt,
  setSpeed,
} from './machine_room';
import { backend, expect, goToRoom, makeRibbon, openSample, openSampleIn, solve, strip, test } from './page';

test.skip(
  backend !== 'wasm',
  'the mock makes reliefs only; the worker’s own machines: machines_of_the_worker.spec.ts',
);

test('from the sample star to a finished laser job', async ({ page }) => {
  test.setTimeout(300_000);
  await openSampleIn(page, 'Zippable', 'Star');
  await makeRibbon(page);
  await page.getByRole('radio', { name: 'Sheets to cut' }).click();
  // Smaller than the bed: the job begins where the head is led.
  for (const name of ['Sheet width', 'Sheet depth']) {
    await page.getByRole('textbox', { name }).fill('300');
    await page.getByRole('textbox', { name }).press('Enter');
  }
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
  await expect(button(page, 'Practise the job')).toBeEnabled();
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
  await page.getByRole('radio', { name: '16×', exact: true }).click(); // two minutes of a real laser
  await expect(strip(page, / is done$/)).toBeVisible({ timeout: 150_000 });
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
  await expect(chip(page)).toHaveText('Paused');
  await expect(strip(page, 'Paused: square')).toBeVisible();
  await press('Resume');
  await expect(dialog(page).getByRole('button', { name: 'Cancel' })).toBeFocused();
  await page.keyboard.press('Tab');
  await page.keyboard.press('Enter');
  await expect(chip(page)).toHaveText('Working');
  await expect(strip(page, 'square is done')).toBeVisible({ timeout: 120_000 });
});

test('a practice job is sped up by keyboard; its time stays that of a real machine', async ({ page }) => {
  await openDrawing(page);
  await makeReady(page);
  const speeds = page.getByRole('radiogroup', { name: 'Speed of practice jobs' });
  await expect(speeds.getByRole('radio', { name: '1×', exact: true })).toBeChecked();
  await expect(speeds).toHaveAccessibleDescription(/^Job time and log are those of a real machine/);
  await startIt(page);
  const start_ms = Date.now();
  await speeds.getByRole('radio', { name: '1×', exact: true }).focus();
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('ArrowRight');
  await expect(speeds.getByRole('radio', { name: '16×', exact: true })).toBeFocused();
  await expect(strip(page, 'square is done')).toBeVisible();
  const onWall_s = (Date.now() - start_ms) / 1000;
  const detail = (await page.getByRole('contentinfo').textContent()) ?? '';
  const ofMachine_s = Number(/lines in (\d+)\ss/.exec(detail)?.[1]);
  expect(ofMachine_s).toBeGreaterThan(15); // 190 mm at 10 mm/s, and a mark
  expect(onWall_s).toBeLessThan(0.6 * ofMachine_s);
  await page.getByRole('radio', { name: 'Console' }).click();
  await page.getByText('1 job so far').click();
  await expect(page.getByText(/^Practice laser, practice, /)).toBeVisible();
  await expect(page.getByText(new RegExp(`done after ${ofMachine_s}\\ss`))).toBeVisible();

  // On a phone it fits, and Stop is obeyed at once: in a job of three minutes.
  await setSpeed(page, 'Cut', '1');
  await page.setViewportSize({ width: 390, height: 844 });
  const box = await speeds.boundingBox();
  expect(box?.x).toBeGreaterThanOrEqual(0);
  expect((box?.x ?? 0) + (box?.width ?? 999)).toBeLessThanOrEqual(390);
  await speeds.getByRole('radio', { name: '4×', exact: true }).click();
  await startIt(page);
  await button(page, 'Stop').click();
  await expect(strip(page, /^Job stopped at \d+ %$/)).toBeVisible({ timeout: 3000 });
  await button(page, 'Disconnect').click();
  await expect(speeds).toHaveCount(0);
});

test('stopped in the middle: the position is unknown, and the rest is cut after homing', async ({ page }) => {
  await openDrawing(page);
  await makeReady(page);
  await startIt(page);
  await expect(page.getByRole('progressbar')).not.toHaveAttribute('aria-valuenow', /^[0-9]$/);
  await button(page, 'Stop').click();
  await expect(strip(page, /^Job stopped at \d+ %$/)).toBeVisible();
  await expect(position(page).getByText('unknown')).toHaveCount(2);
  await expect(chip(page)).toHaveText('Stopped');
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
  await goToRoom(page, 'Relief');
  const bar = page.getByRole('complementary', { name: 'The machine' });
  await expect(bar.getByText(/^Working on square/)).toBeVisible();
  await page.keyboard.press('Control+.');
  await expect(bar).toBeHidden();
  await goToRoom(page, 'Machines');
  await expect(strip(page, /^Job stopped at/)).toBeVisible();
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
  // Sent here, its job is made at once.
  await expect(strip(page, 'Job ready')).toBeVisible({ timeout: 150_000 });
  const figures = page.getByRole('region', { name: 'What is carved' });
  await expect(figures).toContainText('Mean deviation');
  await expect(figures).toContainText(/Size40\.0 × 40\.0 × 5\.00\smm/);
  await expect(page.getByRole('img', { name: /^Bed of 300 × 200/ })).toBeVisible();

  await page.getByRole('radio', { name: '3D' }).click();
  // The carved surface is shown first, the paths over it on request.
  const paths = page.getByRole('switch', { name: 'Show tool paths' });
  await expect(paths).not.toBeChecked();
  await paths.click();
  await expect(paths).toBeChecked();
  const view = page.getByRole('application', { name: 'Tool path' });
  await view.focus();
  await page.keyboard.press('ArrowLeft');
  await page.getByLabel('Time in the job').focus();
  await page.keyboard.press('Home');
  await page.keyboard.press('PageUp');
  await expect(page.locator('.path-view .fw-marker')).toBeVisible();

  await makeMillReady(page);
  await button(page, 'Set z here').click();
  // Two tools are two jobs, with z set between them: z of the tool before cannot be kept.
  const jobs = page.getByRole('region', { name: 'Jobs, in order' });
  await jobs.getByRole('button', { name: 'Run this job next' }).click();
  await startButton(page).click();
  await expect(dialog(page).getByText(/^The finishing tool is mounted, and its tip touches/)).toBeVisible();
  await expect(dialog(page).getByRole('button', { name: 'Set z here and start the spindle' })).toBeVisible();
  await expect(dialog(page).getByRole('radio')).toHaveCount(0);
  await dialog(page).getByRole('button', { name: 'Cancel' }).click();
  await jobs.getByRole('button', { name: 'Run this job next' }).click();
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
  await expect(strip(page, /^Job stopped at/)).toBeVisible();

  // Another depth is another job: the old one cannot be started.
  await page.getByRole('textbox', { name: 'Depth', exact: true }).fill('4');
  await page.getByRole('textbox', { name: 'Depth', exact: true }).press('Enter');
  await expect(button(page, 'Make the job')).toBeVisible();
  await expect(startButton(page)).toHaveAttribute('aria-disabled', 'true');

  // A drawing is no work for a mill: the practice mill is exchanged for the practice laser.
  await page.getByLabel('Model or project file').setInputFiles(square);
  await expect(page.locator('.profile-button')).toHaveText('Practice laser');
  await expect(strip(page, 'Job ready')).toBeVisible();
  await expect(chip(page)).toHaveText('Locked');
});
