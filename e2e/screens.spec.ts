// SPDX-License-Identifier: GPL-3.0-or-later
// The comparison of screens finds what a person would see, and only that.
import { backend, expect, openPage, test } from './page';
import { compare, largestShare } from './screens';

test.skip(backend === 'native', 'the worker serves the same page');

test('a screen is as it was until something is missing, moves or has another colour', async ({ page }) => {
  await openPage(page);
  await page.evaluate(() =>
    Promise.all([...document.images].map((image) => image.decode().catch(() => null))),
  );
  const { webp } = await compare(page, null);
  const shareAfter = async (change: string) => {
    const style = await page.addStyleTag({ content: change });
    const { share } = await compare(page, webp);
    await style.evaluate((element) => (element as Element).remove());
    return share;
  };
  expect(await shareAfter('body {}')).toBeLessThan(0.001);
  for (const seen of [
    '.craft-card:first-child { visibility: hidden }',
    '.start-inner { transform: translateY(40px) }',
    '.craft-card { background: #d8d8d8 }',
  ])
    expect(await shareAfter(seen), seen).toBeGreaterThan(largestShare);
  // Letters drawn a little otherwise are the same letters.
  expect(await shareAfter('* { text-rendering: geometricPrecision }')).toBeLessThan(largestShare);
});
