// SPDX-License-Identifier: GPL-3.0-or-later
// Follows a tutorial in the page's own overlay, by the steps that the overlay and the documents have.
import type { Locator, Page } from '@playwright/test';
import type { Control, Step, Tutorial } from '../web/src/app/learn/tutorial';
import { expect } from './page';

export const learnCard = (page: Page) => page.locator('.learn-card');
const ring = (page: Page) => page.locator('.learn-ring');
/** A diagnosis takes its time on a machine that does other things, too; pictures are worth any wait. */
const step_ms = process.env['FORMWRIGHT_TUTORIAL_PICTURES'] === '1' ? 1_800_000 : 420_000;

const literally = (text: string) => text.replaceAll(/[.*+?^${}()|[\]\\]/g, '\\$&');

/** As a screen reader lists it; a question that stands open is all there is. */
async function find(page: Page, { role, name, exact }: Control): Promise<Locator> {
  const dialog = page.locator('dialog[open]');
  const scope = (await dialog.count()) > 0 ? dialog.last() : page;
  const named = scope.getByRole(role, { name: new RegExp(`^${literally(name)}${exact ? '$' : ''}`) });
  return named.filter({ visible: true }).first();
}

/** The ring is around the control that the story finds by itself. */
async function expectRingAround(page: Page, control: Locator): Promise<void> {
  await expect(async () => {
    const [around, box] = [await ring(page).boundingBox(), await control.boundingBox()];
    if (around === null || box === null) throw new Error('Nothing is pointed at.');
    expect(Math.abs(around.x + around.width / 2 - box.x - box.width / 2)).toBeLessThan(4);
    expect(Math.abs(around.y + around.height / 2 - box.y - box.height / 2)).toBeLessThan(4);
  }).toPass({ timeout: 20_000 });
}

async function act(page: Page, { act: what, control }: Step): Promise<void> {
  if (what.do === 'look') return await learnCard(page).getByRole('button', { name: 'Next' }).click();
  if (control === null) return;
  const found = await find(page, control);
  await found.scrollIntoViewIfNeeded();
  await expectRingAround(page, found);
  if (what.do === 'press') await found.click();
  else if (what.do === 'choose') await found.selectOption({ label: what.value });
  else if (what.do === 'enter') {
    await found.fill(what.value);
    await found.press('Enter');
  } else if (what.do === 'keys') {
    await found.focus();
    for (const key of what.keys) await page.keyboard.press(key);
  }
}

/** Every step is done once, and the overlay notices it; `after` is called with each. */
export async function followTutorial(
  page: Page,
  tutorial: Tutorial,
  after: (step: Step) => Promise<void> = async () => undefined,
): Promise<void> {
  const count = tutorial.steps.length;
  for (const [i, step] of tutorial.steps.entries()) {
    // What is only waited for may be there already.
    if (step.act.do !== 'wait') {
      await expect(learnCard(page)).toContainText(`Step ${i + 1} of ${count}`);
      await expect(learnCard(page)).toContainText(step.text.replaceAll('**', ''));
    }
    await act(page, step);
    const next = i + 1 < count ? `Step ${i + 2} of ${count}` : 'All steps done';
    await expect(learnCard(page), step.text).toContainText(next, { timeout: step_ms });
    await after(step);
  }
}
