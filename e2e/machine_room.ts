// SPDX-License-Identifier: GPL-3.0-or-later
// What the stories of the machines' room share: a drawing, the practice machine, its questions and buttons.
import type { Page } from '@playwright/test';
import { expect, fileOf, goToRoom, openPage, strip } from './page';

/** A square with a hole, and a mark: 40 by 40 mm. */
export const square = fileOf(
  'square.svg',
  `<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="40mm" viewBox="0 0 40 40">
  <g id="cut" fill="none" stroke="#f00"><path d="M1 1H39V39H1Z"/><circle cx="20" cy="20" r="6"/></g>
  <g id="mark" fill="none" stroke="#00f"><path d="M5 5H15"/></g></svg>`,
);

export const chip = (page: Page) => page.locator('.state-chip');
export const position = (page: Page) => page.getByRole('group', { name: /^Position of the head/ });
export const button = (page: Page, name: string) => page.getByRole('button', { name, exact: true });
/** Disabled buttons say why in their name. */
export const startButton = (page: Page) =>
  page.locator('.inspector-foot').getByRole('button', { name: /^Start/ });
export const dialog = (page: Page) => page.getByRole('dialog');

export async function openRoom(page: Page): Promise<void> {
  await openPage(page);
  await goToRoom(page, 'Machines');
  await expect(button(page, 'Practise without a machine')).toBeVisible();
}

export async function openDrawing(page: Page, file = square): Promise<void> {
  await openRoom(page);
  await page.getByLabel('Model or project file').setInputFiles(file);
  await expect(strip(page, 'Job ready')).toBeVisible();
}

/** Adds a laser with a bed of this size, which is chosen then. */
export async function addLaser(page: Page, name: string, width_mm: string, depth_mm: string): Promise<void> {
  await goToRoom(page, 'Machines');
  const menu = page.locator('.profile-button');
  await menu.click();
  await page.getByRole('menuitem', { name: 'Add a machine' }).click();
  await dialog(page).getByLabel('Name').fill(name);
  await dialog(page).getByLabel('Bed width, mm').fill(width_mm);
  await dialog(page).getByLabel('Bed depth, mm').fill(depth_mm);
  await dialog(page).getByRole('button', { name: 'Add', exact: true }).click();
  await expect(menu).toHaveText(name);
}

/** Nothing is done before the question is answered, and the focus stands on Cancel. */
export async function confirm(page: Page, title: RegExp, action: string, says: RegExp): Promise<void> {
  await expect(dialog(page).getByRole('heading', { name: title })).toBeVisible();
  await expect(dialog(page).getByText(says)).toBeVisible();
  await expect(dialog(page).getByRole('button', { name: 'Cancel' })).toBeFocused();
  await dialog(page).getByRole('button', { name: action, exact: true }).click();
}

export async function practise(page: Page): Promise<void> {
  await button(page, 'Practise without a machine').click();
  await expect(chip(page)).toHaveText('Locked');
  await expect(position(page).getByText('unknown')).toHaveCount(2);
}

export async function homeIt(page: Page): Promise<void> {
  await page.locator('.machine-buttons').getByRole('button', { name: 'Home' }).click();
  await confirm(page, /^Home the machine/, 'Home', /moves to its homing switches/);
  await expect(chip(page)).toHaveText('Ready');
  await expect(position(page).getByText('unknown')).toHaveCount(0);
}

/** A practice mill, homed, its tool below its switches: from there a job would leave the machine's reach. */
export async function makeMillReady(page: Page): Promise<void> {
  await button(page, 'Practise without a machine').click();
  await expect(chip(page)).toHaveText('Locked');
  await page.locator('.machine-buttons').getByRole('button', { name: 'Home' }).click();
  await confirm(page, /^Home the machine/, 'Home', /moves to its homing switches/);
  await expect(chip(page)).toHaveText('Ready');
  await page.getByRole('button', { name: 'Move the tool down' }).focus();
  await page.keyboard.press('Shift+PageDown');
  await expect(chip(page)).toHaveText('Moving');
  await expect(chip(page)).toHaveText('Ready');
}

export const coordinate = async (page: Page, axis: 'X' | 'Y'): Promise<number> => {
  const text = await position(page).locator('div', { hasText: axis }).locator('b').textContent();
  return Number((text ?? '').replace('−', '-'));
};

/** Holds the key until the head has gone so far, and sees that it stops when it is let go. */
export async function holdJog(page: Page, name: string, axis: 'X' | 'Y', beyond_mm: number): Promise<void> {
  await page.getByRole('button', { name: `Move ${name}` }).hover();
  await page.mouse.down();
  await expect.poll(() => coordinate(page, axis), { timeout: 30_000 }).toBeGreaterThan(beyond_mm);
  await page.mouse.up();
  await expect(chip(page)).toHaveText('Ready');
  const rested = await coordinate(page, axis);
  await page.waitForTimeout(400);
  expect(await coordinate(page, axis)).toBeCloseTo(rested, 1);
}

export async function setOrigin(page: Page): Promise<void> {
  await button(page, 'Set origin here').click();
  await expect.poll(() => coordinate(page, 'X')).toBeCloseTo(0, 1);
  await expect.poll(() => coordinate(page, 'Y')).toBeCloseTo(0, 1);
}

export async function makeReady(page: Page): Promise<void> {
  await practise(page);
  await homeIt(page);
}

export async function startIt(page: Page): Promise<void> {
  await startButton(page).click();
  await confirm(page, /^Start /, 'Start with the laser on', /laser turns on/);
  await expect(chip(page)).toHaveText('Working');
}

export async function setSpeed(page: Page, group: string, mm_per_s: string): Promise<void> {
  await page.getByRole('button', { name: new RegExp(`^${group} \\d+$`) }).click();
  const field = page
    .getByRole('region', { name: group, exact: true })
    .getByRole('textbox', { name: 'Speed' });
  await field.fill(mm_per_s);
  await field.press('Enter');
}
