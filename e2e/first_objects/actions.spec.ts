// SPDX-License-Identifier: GPL-3.0-or-later
// The counter itself, on a page of its own: which events are one action, and that a script cannot get round it.
import type { Page } from '@playwright/test';
import { expect, fileOf, test } from '../page';
import type { ActionCount } from './actions';
import { countActions } from './actions';

const html = `<!doctype html>
<button>Make</button> <label>Width <input type="text"></label> <input aria-label="Depth" type="number">
<select aria-label="Cloth"><option>Felt<option>Denim</select> <input type="range" aria-label="Time">
<input type="checkbox" aria-label="Mirror">
<input type="file" multiple aria-label="Model"> <button onclick="document.querySelector('[type=file]').click()">Open</button>
<div aria-label="Bed" role="img" style="width: 300px; height: 200px; background: #ddd"></div>`;

async function blank(page: Page): Promise<ActionCount> {
  const counter = await countActions(page);
  await page.route('**/blank', (route) => route.fulfill({ contentType: 'text/html', body: html }));
  await page.goto('/blank');
  await counter.begin();
  return counter;
}
const done = async (counter: ActionCount) =>
  (await counter.end()).actions.map(({ kind, what }) => `${kind}: ${what}`);

test('a press, a drag, a key; not moving, scrolling and holding a key', async ({ page }) => {
  const counter = await blank(page);
  await page.getByRole('button', { name: 'Make' }).click();
  await page.getByRole('button', { name: 'Make' }).hover();
  await page.mouse.wheel(0, 100);
  expect(await done(counter)).toEqual(['press: Make']);
  const bed = await page.getByLabel('Bed').boundingBox();
  if (bed === null) throw new Error('The bed is not to be seen.');
  await page.mouse.move(bed.x + 10, bed.y + 10);
  await page.mouse.down();
  await page.mouse.move(bed.x + 90, bed.y + 50, { steps: 5 });
  await page.mouse.up();
  await page.mouse.dblclick(bed.x + 10, bed.y + 10);
  expect((await done(counter)).slice(1)).toEqual(['drag: Bed', 'press: Bed', 'press: Bed']);

  await counter.begin();
  await page.getByRole('checkbox').click();
  await page.keyboard.down('ArrowRight');
  await page.keyboard.down('ArrowRight'); // repeated, as long as it is held
  await page.keyboard.up('ArrowRight');
  await page.keyboard.press('Control+Enter');
  await page.keyboard.press('Shift+Tab');
  await page.keyboard.press('?');
  expect(await done(counter)).toEqual([
    'press: Mirror',
    'key: ArrowRight',
    'key: Ctrl+Enter',
    'key: Shift+Tab',
    'key: ?',
  ]);
});

test('a text with its Enter is one; the press into the field is another', async ({ page }) => {
  const counter = await blank(page);
  const width = page.getByRole('textbox', { name: 'Width' });
  await width.click();
  await page.keyboard.type('120');
  await page.keyboard.press('Control+a');
  await page.keyboard.type('300');
  await page.keyboard.press('Enter');
  expect(await done(counter)).toEqual(['press: Width', 'text: Width']);
  await page.keyboard.type('400');
  await page.keyboard.press('Tab');
  await page.keyboard.type('5');
  expect((await done(counter)).slice(2)).toEqual(['text: Width', 'key: Tab', 'text: Depth']);
  await counter.begin();
  await page.getByText('Width').click(); // the label brings the focus
  await page.keyboard.type('1');
  await page.keyboard.press('Escape');
  expect(await done(counter)).toEqual(['press: Width', 'text: Width', 'key: Escape']);
});

test('files chosen together are one, a choice in a list is one', async ({ page }) => {
  const counter = await blank(page);
  const choosing = page.waitForEvent('filechooser');
  await page.getByRole('button', { name: 'Open' }).click();
  await (await choosing).setFiles([fileOf('a.obj', 'a'), fileOf('a.mtl', 'b')]);
  expect(await done(counter)).toEqual(['press: Open', 'files: a.obj, a.mtl']);
  await counter.begin();
  await page.getByRole('combobox').selectOption('Denim');
  expect(await done(counter)).toEqual(['choice: Denim']);
  await counter.begin();
  await page.getByLabel('Bed').evaluate((bed) => {
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File(['a'], 'b.obj'));
    bed.dispatchEvent(new DragEvent('drop', { dataTransfer, bubbles: true }));
  });
  expect(await done(counter)).toEqual(['files: b.obj']);
});

test('what a script does for a person is counted as if the person had done it', async ({ page }) => {
  const counter = await blank(page);
  await page.getByRole('button', { name: 'Make' }).evaluate((button: HTMLButtonElement) => button.click());
  await page.getByRole('button', { name: 'Make' }).dispatchEvent('click');
  expect(await done(counter)).toEqual(['press: Make', 'press: Make']);
  await counter.begin();
  await page.getByRole('textbox', { name: 'Width' }).fill('7');
  await page.getByRole('textbox', { name: 'Width' }).press('Enter');
  await page.getByRole('spinbutton').fill('8');
  expect(await done(counter)).toEqual(['press: Width', 'text: Width', 'press: Depth', 'text: Depth']);
});

test('it goes on counting after the page was loaded anew', async ({ page }) => {
  const counter = await blank(page);
  await page.getByRole('button', { name: 'Make' }).click();
  await page.reload();
  await page.getByRole('button', { name: 'Make' }).click();
  expect(await done(counter)).toHaveLength(2);
});

test.describe('with fingers', () => {
  test.use({ hasTouch: true });
  test('a tap is one', async ({ page }) => {
    const counter = await blank(page);
    await page.getByRole('button', { name: 'Make' }).tap();
    expect(await done(counter)).toEqual(['press: Make']);
  });
});
