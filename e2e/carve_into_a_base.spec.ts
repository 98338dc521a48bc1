// SPDX-License-Identifier: GPL-3.0-or-later
// A relief worked into another surface than a flat plate, up to the mill that carves it.
import { chip, dialog, makeMillReady, startButton } from './machine_room';
import { backend, expect, fileOf, openSample, solve, strip, test } from './page';

test.skip(backend !== 'wasm', 'the page does the same with the worker');

test('a V groove is carved on a practice mill', async ({ page }) => {
  test.setTimeout(420_000);
  await openSample(page);
  const field = (name: string) => page.getByRole('textbox', { name, exact: true });
  const set = async (name: string, value: string) => {
    await field(name).fill(value);
    await field(name).press('Enter');
  };
  // What belongs to a base that is not flat is offered with it.
  await expect(field('Depth of the base')).toBeHidden();
  await page.getByRole('combobox', { name: 'Shape of the base' }).selectOption('V groove');
  await expect(field('Depth of the base')).toBeVisible();
  for (const [name, value] of [
    ['Width', '40'],
    ['Thickness', '1'],
    ['Carve into the base', '2'],
    ['Depth of the base', '8'],
  ] as const)
    await set(name, value);
  await solve(page);
  await page.getByRole('button', { name: 'Send to a machine', exact: true }).click();
  await expect(page.locator('.profile-button')).toHaveText('Practice mill');
  // From 2 mm below the bottom of the groove to 1 mm above the plate.
  await expect(field('Depth')).toHaveValue('11.0');
  await expect(strip(page, 'Job ready')).toBeVisible({ timeout: 150_000 });
  await expect(page.getByRole('region', { name: 'What is carved' })).toContainText(
    /Size40\.0 × 40\.0 × ([89]|10|11)\.\d\d?\smm/,
  );
  await makeMillReady(page);
  await startButton(page).click();
  await dialog(page).getByRole('button', { name: 'Set z here and start the spindle' }).click();
  await expect(chip(page)).toHaveText('Working');
  await page.getByRole('radio', { name: 'Fastest', exact: true }).click();
  await expect(strip(page, / is done$/)).toBeVisible({ timeout: 150_000 });
});

test('a groove is moved and turned by its handles, and stays on its plate', async ({ page }) => {
  await openSample(page);
  const field = (name: string) => page.getByRole('textbox', { name, exact: true });
  const move = page.getByRole('button', { name: /^Move the groove\. / });
  const turn = page.getByRole('button', { name: /^Turn the (groove|strips)\. / });
  await page.getByRole('radio', { name: 'Relief', exact: true }).click();
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await expect(move).toBeHidden();
  await page.getByRole('combobox', { name: 'Shape of the base' }).selectOption('V groove');
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await move.focus();
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('ArrowUp');
  await expect(field('Shift of the base')).toHaveValue(/^5(\.0)?$/);
  await page.keyboard.press('Control+z');
  await expect(field('Shift of the base')).toHaveValue(/^0(\.0)?$/);
  await turn.focus();
  for (let k = 0; k < 6; ++k) await page.keyboard.press('ArrowLeft');
  await expect(field('Turn of the base')).toHaveValue(/^90/);
  // Turned by a quarter, it goes up and down.
  const box = await move.boundingBox();
  if (box === null) throw new Error('the handle has no place');
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 50, y - 30, { steps: 4 });
  await page.mouse.up();
  await expect(field('Shift of the base')).toHaveValue(/^\d/);
  await expect(field('Shift of the base')).not.toHaveValue(/^0(\.0)?$/);
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  const there = await move.boundingBox();
  expect(Math.abs((there?.x ?? 0) - box.x)).toBeLessThan(3);
  expect((there?.y ?? 0) - box.y).toBeLessThan(-20);
  // Farther than the plate it does not go; in numbers it is refused.
  await move.focus();
  for (let k = 0; k < 30; ++k) await page.keyboard.press('ArrowUp');
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await field('Shift of the base').fill('900');
  await field('Shift of the base').press('Enter');
  await expect(
    page.getByRole('alert').getByText(/shifted by more than half the plate: shift it by less than \d/),
  ).toBeVisible();
  await page.getByRole('combobox', { name: 'Shape of the base' }).selectOption('Strips');
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await expect(turn).toBeVisible();
  await expect(page.getByRole('button', { name: /^Move the strips/ })).toBeHidden();
});

test('a base from a file takes the place of the built-in shapes, and says where it ends', async ({
  page,
}) => {
  await openSample(page);
  /** A tilted square, `half_mm` in each direction from the middle. */
  const plane = (half_mm: number) =>
    fileOf(
      'wall.obj',
      [-1, 1]
        .flatMap((y) => [-1, 1].map((x) => `v ${x * half_mm} ${y * half_mm} ${0.1 * x * half_mm}`))
        .concat('f 1 2 4 3')
        .join('\n'),
    );
  const file = page.getByLabel('File of the base');
  await file.setInputFiles(plane(200));
  await expect(page.getByText('wall.obj')).toBeVisible();
  await expect(page.getByRole('combobox', { name: 'Shape of the base' })).toBeHidden();
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  // It is moved by handles on the relief, in numbers, and back.
  const field = (name: string) => page.getByRole('textbox', { name, exact: true });
  await page.getByRole('radio', { name: 'Relief', exact: true }).click();
  const move = page.getByRole('button', { name: /^Move wall\.obj\. / });
  await expect(move).toBeVisible();
  await move.focus();
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('Shift+ArrowUp');
  await expect(field('Base to the right')).toHaveValue('5');
  await expect(field('Base upwards')).toHaveValue('1');
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  const box = await move.boundingBox();
  if (box === null) throw new Error('the handle has no place');
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x - 40, y + 20, { steps: 4 });
  await page.mouse.up();
  await expect(field('Base to the right')).toHaveValue(/^−\d/);
  await expect(field('Base upwards')).toHaveValue(/^−\d/);
  await page.getByRole('button', { name: /^Turn wall\.obj\. / }).focus();
  await page.keyboard.press('ArrowLeft');
  await expect(field('Turn of the base file')).toHaveValue(/^15/);
  await page.getByRole('button', { name: /^Move wall\.obj away / }).focus();
  await page.keyboard.press('ArrowUp');
  await expect(field('Base forwards')).toHaveValue(/^−5/);
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await page.keyboard.press('Control+z');
  await expect(field('Base forwards')).toHaveValue(/^0/);

  await file.setInputFiles(plane(20));
  await expect(
    page.getByRole('alert').getByText(/The base ends before the model does: \d+ of \d+ vertices/),
  ).toBeVisible();
  await page.getByRole('button', { name: 'Remove', exact: true }).click();
  await expect(move).toBeHidden();
  await expect(field('Base to the right')).toBeHidden();
  await expect(strip(page, 'Preview up to date')).toBeVisible();
  await expect(page.getByRole('combobox', { name: 'Shape of the base' })).toBeVisible();
});
