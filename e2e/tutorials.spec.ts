// SPDX-License-Identifier: GPL-3.0-or-later
// Every tutorial from its start to its end, by its own steps. With FORMWRIGHT_TUTORIAL_PICTURES=1 its pictures are taken on the way.
import type { Page } from '@playwright/test';
import { mkdirSync, readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { inflateRawSync } from 'node:zlib';
import { tutorials } from '../web/src/app/learn/tutorials/index';
import { followTutorial, learnCard } from './follow_tutorial';
import { scannedSheet } from './measured_object';
import { backend, expect, expectAccessible, goToRoom, inEveryLook, openPage, test } from './page';

test.skip(backend !== 'wasm', 'the mock makes reliefs only; the worker serves the same page');

const takesPictures = process.env['FORMWRIGHT_TUTORIAL_PICTURES'] === '1';
const folder = resolve(import.meta.dirname, '../docs/img/tutorials');
/** A view draws coarsely first and says so; on a busy machine what is better takes its time. */
const patience_ms = 300_000;

async function begin(page: Page, title: string): Promise<void> {
  await openPage(page);
  await page.getByRole('button', { name: new RegExp(`^${title}`) }).click();
  await expect(learnCard(page)).toContainText('Step 1 of');
}

/** The document of a saved project: the archive's first file, deflated. */
function projectIn(archive: Buffer): string {
  const [nameLength, extraLength] = [archive.readUInt16LE(26), archive.readUInt16LE(28)];
  const begin = 30 + nameLength + extraLength;
  expect(archive.toString('latin1', 30, 30 + nameLength)).toBe('project.json');
  return inflateRawSync(archive.subarray(begin, begin + archive.readUInt32LE(18))).toString();
}

/** The page alone, as the reader will see it on a machine that is quick enough. */
async function takePicture(page: Page, name: string): Promise<void> {
  mkdirSync(folder, { recursive: true });
  const slow = page.getByRole('button', { name: 'Keep working here' });
  if (await slow.isVisible()) await slow.click();
  const hidden = await page.addStyleTag({ content: '.learn { visibility: hidden; }' });
  await page.mouse.move(640, 4);
  await expect(page.locator('.fw-view[data-drawing]')).toHaveCount(0, { timeout: patience_ms });
  await page.waitForTimeout(1000); // until the browser has put it onto the screen
  await page.screenshot({ path: resolve(folder, `${name}.png`) });
  await hidden.evaluate((style: Element) => style.remove());
}

for (const tutorial of tutorials)
  test(`${tutorial.name}: ${tutorial.title}`, async ({ page }) => {
    test.setTimeout(takesPictures ? 3_600_000 : 900_000);
    await begin(page, tutorial.title);
    await followTutorial(page, tutorial, async ({ picture }) => {
      if (takesPictures && picture) await takePicture(page, picture.name);
    });
    await learnCard(page).getByRole('button', { name: 'Close' }).click();
    await expect(learnCard(page)).toBeHidden();
  });

test('the picture of a measured scan, which no step shows', async ({ page }) => {
  test.skip(!takesPictures, 'measuring a scan is a story of its own');
  test.setTimeout(600_000);
  await openPage(page);
  await goToRoom(page, 'Evidence');
  const { scan, picture, pattern } = scannedSheet();
  await page.getByLabel('Model or project file').setInputFiles([scan, picture, pattern]);
  await page.getByRole('button', { name: 'Measure the scan' }).click();
  await expect(page.getByRole('button', { name: 'Use these points' })).toBeVisible({ timeout: 500_000 });
  await takePicture(page, 'evidence_scan');
});

test('by keyboard, from Help, left in the middle: nothing of it is in the project', async ({ page }) => {
  test.skip(takesPictures, 'no picture is taken here');
  test.setTimeout(420_000);
  await openPage(page);
  await page.getByRole('button', { name: 'Help' }).focus();
  await page.keyboard.press('Enter');
  await page.keyboard.press('Enter'); // the first entry: Learn
  const dialog = page.getByRole('dialog', { name: 'Learn' });
  await dialog.getByRole('button', { name: /^A relief of a head/ }).focus();
  await page.keyboard.press('Enter');
  // The dialog gives the focus back to Help as it closes; a moment later the card has it for good.
  await expect(dialog).toBeHidden();
  await expect(async () => {
    await expect(learnCard(page)).toBeFocused();
    await page.waitForTimeout(300);
    await expect(learnCard(page)).toBeFocused({ timeout: 100 });
  }).toPass();
  await expect(page.getByRole('button', { name: /^Nothing to undo/ })).toBeVisible();
  await page.keyboard.press('Tab'); // Leave
  await page.keyboard.press('Tab');
  await expect(page.getByRole('button', { name: 'Show me where' })).toBeFocused();
  await page.keyboard.press('Enter');
  await expect(page.locator('.gallery button', { hasText: 'Bust' })).toBeFocused();
  await page.keyboard.press('Enter');
  await expect(learnCard(page)).toContainText('Step 2 of');

  // Another room than the step's says the way back.
  await goToRoom(page, 'Zippable');
  await expect(learnCard(page)).toContainText('This step is in another room. Choose Relief');
  await goToRoom(page, 'Relief');
  await expect(learnCard(page)).toContainText('Turn the head');

  // It outlives a reload, and is gone once it is left.
  await expect(page.getByText('Saved', { exact: true })).toBeVisible();
  await page.reload();
  await expect(learnCard(page)).toContainText('Step 2 of');
  await page.getByRole('button', { name: 'Leave the tutorial' }).click();
  await expect(learnCard(page)).toBeHidden();
  await page.getByRole('button', { name: 'Bust', exact: true }).click(); // the project's menu
  const waiting = page.waitForEvent('download');
  await page.getByRole('menuitem', { name: 'Save as a file' }).click();
  const document = projectIn(readFileSync(await (await waiting).path()));
  expect(document).toContain('Bust');
  expect(document).not.toMatch(/tutorial|learn/i);
});

test(
  'axe finds nothing serious while one learns, and the card is off its control',
  { tag: '@screens' },
  async ({ page }) => {
    test.skip(backend === 'native', 'the worker serves the same page');
    test.skip(takesPictures, 'no picture is taken here');
    // The note that solving takes a while comes with a slow or busy computer only.
    await page.addInitScript(() => sessionStorage.setItem('formwright.relief.no-worker-note', '1'));
    await begin(page, 'A relief of a head');
    await expectAccessible(page, 'first step');
    await page.locator('.gallery button', { hasText: 'Bust' }).click();
    await expect(learnCard(page)).toContainText('Step 2 of');
    await learnCard(page).getByRole('button', { name: 'Skip this step' }).click();
    await expectAccessible(page, 'third step', 'tutorial');
    await learnCard(page).getByRole('button', { name: 'Show me where' }).click();
    await expect(page.getByRole('button', { name: /^Use this view/ })).toBeFocused();
    await inEveryLook(page, async (look) => {
      await expect(async () => {
        const [card, control] = [
          await learnCard(page).boundingBox(),
          await page.getByRole('button', { name: /^Use this view/ }).boundingBox(),
        ];
        if (card === null || control === null) throw new Error(`${look}: card or control is not to be seen.`);
        const apart =
          card.x + card.width <= control.x ||
          control.x + control.width <= card.x ||
          card.y + card.height <= control.y ||
          control.y + control.height <= card.y;
        expect(apart, look).toBe(true);
      }).toPass({ timeout: 5000 });
    });
  },
);
