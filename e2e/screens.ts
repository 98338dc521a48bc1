// SPDX-License-Identifier: GPL-3.0-or-later
// Screens as they were looked at and found good, in screens/: half as large, one for each look. A page that draws something
// else fails until somebody has looked at it and keeps the new picture (`npm run screens`).
import { expect, type Page } from '@playwright/test';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';

const kept = resolve(import.meta.dirname, 'screens');
const seen = resolve(import.meta.dirname, 'test-results/screens');
const keeping = process.env['FORMWRIGHT_KEEP_SCREENS'] !== undefined;

/** Eight pixels wide: letters that another version of the browser smooths otherwise are the same there. */
const block_px = 8;
/** Of 255, of the mean of a block. */
const largestDifference = 16;
/** A missing card or a shifted panel is more. */
export const largestShare = 0.02;

/** What says how long something took or will take, which differs from run to run. */
const timesOn = (page: Page) => [page.getByRole('contentinfo'), page.locator('.inspector-foot p')];

export interface Compared {
  /** Half as large. */
  readonly webp: Buffer;
  /** Share of the blocks that differ from the picture before; 1 where that has another size. */
  readonly share: number | null;
}

/** What the page shows now, and how much of it is not as in `before`, a WebP picture half as large. */
export async function compare(page: Page, before: Buffer | null): Promise<Compared> {
  const shot = await page.screenshot({
    animations: 'disabled',
    caret: 'hide',
    mask: timesOn(page),
  });
  const { webp, share } = await page.evaluate(
    async ({ now64, before64, block, largest }) => {
      const pictureOf = (base64: string) =>
        createImageBitmap(new Blob([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))]));
      const drawn = (picture: ImageBitmap, width: number, height: number) => {
        const canvas = new OffscreenCanvas(width, height);
        const context = canvas.getContext('2d');
        if (context === null) throw new Error('There is no canvas.');
        context.imageSmoothingQuality = 'high';
        context.drawImage(picture, 0, 0, width, height);
        return { canvas, pixels: context.getImageData(0, 0, width, height).data };
      };
      const now = await pictureOf(now64);
      const size = [Math.round(now.width / 2), Math.round(now.height / 2)] as const;
      const half = await drawn(now, ...size).canvas.convertToBlob({ type: 'image/webp', quality: 0.85 });
      const bytes = new Uint8Array(await half.arrayBuffer());
      const base64 = btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(''));
      if (before64 === null) return { webp: base64, share: null };
      const other = await pictureOf(before64);
      if (other.width !== size[0] || other.height !== size[1]) return { webp: base64, share: 1 };
      const blocks = [Math.floor(now.width / block), Math.floor(now.height / block)] as const;
      // Encoded alike: what the encoder loses is lost in both.
      const [a, b] = [await createImageBitmap(half), other].map(
        (picture) => drawn(picture, ...blocks).pixels,
      );
      let different = 0;
      for (let i = 0; i < 4 * blocks[0] * blocks[1]; i += 4)
        if ([0, 1, 2].some((k) => Math.abs((a?.[i + k] ?? 0) - (b?.[i + k] ?? 0)) > largest)) ++different;
      return { webp: base64, share: different / (blocks[0] * blocks[1]) };
    },
    {
      now64: shot.toString('base64'),
      before64: before?.toString('base64') ?? null,
      block: block_px,
      largest: largestDifference,
    },
  );
  return { webp: Buffer.from(webp, 'base64'), share };
}

/** Fails where the page does not look as it was kept; `name` is the screen's. */
export async function expectSameScreen(page: Page, name: string): Promise<void> {
  await page.mouse.move(0, 0); // no tip lies over the page
  await expect(page.locator('.tip')).toHaveCount(0);
  const dark = await page.evaluate(() => matchMedia('(prefers-color-scheme: dark)').matches);
  const file = `${name}_${dark ? 'dark' : 'light'}_${page.viewportSize()?.width ?? 0}.webp`;
  const before = existsSync(join(kept, file)) ? readFileSync(join(kept, file)) : null;
  const { webp, share } = await compare(page, before);
  const same = share !== null && share <= largestShare;
  if (keeping && !same) {
    mkdirSync(kept, { recursive: true });
    writeFileSync(join(kept, file), webp);
    return;
  }
  if (!same) {
    mkdirSync(seen, { recursive: true });
    writeFileSync(join(seen, file), webp);
  }
  const how = `look at e2e/test-results/screens/${file}, and where it is right run "npm run screens"`;
  expect(share, `e2e/screens/${file} is not there: ${how}`).not.toBeNull();
  expect(share, `share of the screen that is not as in e2e/screens/${file}: ${how}`).toBeLessThanOrEqual(
    largestShare,
  );
}
