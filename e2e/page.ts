// SPDX-License-Identifier: GPL-3.0-or-later
// What the stories share: opening the page with its backend, a model file, an STL reader.
import AxeBuilder from '@axe-core/playwright';
import type { Page } from '@playwright/test';
import { test as base, expect } from '@playwright/test';
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { expectSameScreen } from './screens';

export const backend = process.env['FORMWRIGHT_BACKEND'] ?? 'mock';

/** The address to open: the worker's own, with its token, for the native backend. */
export function address(): string {
  if (backend !== 'native') return '/';
  return readFileSync(resolve(import.meta.dirname, 'test-results/worker_address'), 'utf8');
}

/** Every story fails on an uncaught error or an error in the console. */
export const test = base.extend<{ noErrors: undefined }>({
  noErrors: [
    async ({ page }, use) => {
      const errors: string[] = [];
      page.on('pageerror', (error) => errors.push(String(error)));
      page.on('console', (message) => {
        if (message.type() === 'error') errors.push(message.text());
      });
      await use(undefined);
      expect(errors).toEqual([]);
    },
    { auto: true },
  ],
});
export { expect };

export async function openPage(page: Page): Promise<void> {
  await page.goto(address());
  await expect(page.getByRole('heading', { name: 'What will you make?' })).toBeVisible();
  await expect(page.getByRole('heading', { name: 'Or start from a sample' })).toBeVisible();
}

/** What the strip says; said a second time for the ear only. */
export const strip = (page: Page, title: string | RegExp) =>
  page.getByRole('contentinfo').locator('strong').getByText(title);

export type Room = 'Relief' | 'Thermoform' | 'Zippable' | 'Evidence' | 'Machines';
/** By its name in the bar at the top. */
export async function goToRoom(page: Page, room: Room): Promise<void> {
  await page.getByRole('link', { name: room, exact: true }).click();
}

/** One of the samples of an empty room. */
export async function chooseSample(page: Page, title: string): Promise<void> {
  await page.locator('.gallery button', { hasText: title }).click();
  await expect(strip(page, 'Preview up to date')).toBeVisible();
}

/** The torus is the quickest; stories that are about time take the bust. */
export async function openSample(page: Page, title = 'Torus'): Promise<void> {
  await openPage(page);
  await chooseSample(page, title);
}

export async function openSampleIn(page: Page, room: Room, title: string): Promise<void> {
  await openPage(page);
  await goToRoom(page, room);
  await chooseSample(page, title);
}

/** In the zippable room. */
export async function makeRibbon(page: Page): Promise<void> {
  await page.getByRole('button', { name: 'Make the ribbon', exact: true }).click();
  await expect(strip(page, 'Ribbon unfolded')).toBeVisible({ timeout: 150_000 });
}

/** A model on the start page: the page asks what becomes of it. */
export async function openModel(
  page: Page,
  file: ReturnType<typeof fileOf>,
  craft: 'Relief' | 'Thermoform' | 'Zippable' = 'Relief',
): Promise<void> {
  await page.getByLabel('Model or project file').setInputFiles(file);
  const question = page.getByRole('dialog', { name: `What will you make of ${file.name}?` });
  await question.getByRole('button', { name: craft }).click();
}

export async function solve(page: Page): Promise<void> {
  await page.getByRole('button', { name: 'Solve at full detail' }).click();
  await expect(strip(page, 'Relief ready')).toBeVisible({ timeout: 150_000 });
}

/** A ball with waves, as OBJ: small, closed, ours. */
export function ballObj(rows = 24): string {
  const columns = 2 * rows;
  const lines: string[] = ['v 0 1 0', 'v 0 -1 0'];
  for (let i = 1; i < rows; ++i)
    for (let j = 0; j < columns; ++j) {
      const [v, u] = [(Math.PI * i) / rows, (2 * Math.PI * j) / columns];
      const r = 1 + 0.1 * Math.sin(4 * u) * Math.sin(v) ** 2;
      lines.push(`v ${r * Math.sin(v) * Math.sin(u)} ${r * Math.cos(v)} ${r * Math.sin(v) * Math.cos(u)}`);
    }
  const at = (i: number, j: number) => 3 + (i - 1) * columns + (j % columns);
  for (let j = 0; j < columns; ++j) {
    lines.push(`f 1 ${at(1, j)} ${at(1, j + 1)}`, `f 2 ${at(rows - 1, j + 1)} ${at(rows - 1, j)}`);
    for (let i = 1; i < rows - 1; ++i)
      lines.push(`f ${at(i, j)} ${at(i + 1, j)} ${at(i + 1, j + 1)} ${at(i, j + 1)}`);
  }
  return lines.join('\n');
}

export const fileOf = (name: string, content: string) => ({
  name,
  mimeType: 'application/octet-stream',
  buffer: Buffer.from(content),
});

export interface Solid {
  readonly triangles: number;
  readonly size: readonly number[];
  /** Every edge is used once in each direction. */
  readonly closed: boolean;
}

/** Reads a binary STL; corners with the same coordinates are the same. */
export function readStl(bytes: Buffer): Solid {
  const triangles = bytes.readUInt32LE(80);
  expect(bytes.length).toBe(84 + 50 * triangles);
  const names = new Map<string, number>();
  const edges = new Map<string, number>();
  const [low, high] = [
    [Infinity, Infinity, Infinity],
    [-Infinity, -Infinity, -Infinity],
  ];
  for (let t = 0; t < triangles; ++t) {
    const corners = [0, 1, 2].map((corner) => {
      const at = 84 + 50 * t + 12 + 12 * corner;
      const p = [0, 4, 8].map((offset) => bytes.readFloatLE(at + offset));
      p.forEach((x, k) => {
        low[k] = Math.min(low[k] ?? x, x);
        high[k] = Math.max(high[k] ?? x, x);
      });
      const key = p.join();
      return names.get(key) ?? (names.set(key, names.size), names.size - 1);
    });
    corners.forEach((a, k) => {
      const b = corners[(k + 1) % 3] ?? 0;
      const [key, by] = a < b ? [`${a},${b}`, 1] : [`${b},${a}`, -1];
      edges.set(key, (edges.get(key) ?? 0) + by);
    });
  }
  const closed = [...edges.values()].every((sum) => sum === 0);
  return { triangles, size: high.map((x, k) => x - (low[k] ?? 0)), closed };
}

/** Both themes at both widths. What the worker serves is the same page: there one is enough. */
const looks = (backend === 'native' ? (['light'] as const) : (['light', 'dark'] as const)).flatMap(
  (colorScheme) =>
    (backend === 'native' ? [1280] : [1280, 390]).map((width) => ({
      media: { colorScheme, reducedMotion: 'reduce' as const },
      viewport: { width, height: width === 390 ? 844 : 800 },
    })),
);

/** The state that a story has reached, in every look, without making it anew. */
export async function inEveryLook(page: Page, check: (look: string) => Promise<void>): Promise<void> {
  const before = page.viewportSize();
  for (const { media, viewport } of looks) {
    await page.emulateMedia(media);
    await page.setViewportSize(viewport);
    // The picture follows its frame a moment later.
    await page.evaluate(
      () =>
        new Promise((done) =>
          requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 100))),
        ),
    );
    await check(`${media.colorScheme}, ${viewport.width} px`);
  }
  await page.emulateMedia({ colorScheme: null, reducedMotion: null });
  if (before) await page.setViewportSize(before);
}

/** Fails with what axe finds serious in the page as it is, and where the page itself could scroll; `what` says on which state of it. */
export async function expectAccessibleNow(page: Page, what: string): Promise<void> {
  const { violations } = await new AxeBuilder({ page }).analyze();
  const serious = violations.filter(({ impact }) => impact === 'serious' || impact === 'critical');
  const listed = serious.map(
    ({ id, nodes }) => `${what}: ${id}: ${nodes.map(({ html }) => html.slice(0, 120)).join(' | ')}`,
  );
  expect(listed).toEqual([]);
  const beyond = await page.evaluate(() => document.documentElement.scrollHeight - window.innerHeight);
  expect(beyond, `${what}: px by which the page is longer than the screen`).toBeLessThanOrEqual(0);
}

/**
 * Fails with what axe finds serious in any look; `what` says on which state of the page. `screen` names a state that must
 * look as it was kept, too (screens.ts).
 */
export async function expectAccessible(page: Page, what: string, screen?: string): Promise<void> {
  await inEveryLook(page, async (look) => {
    await expectAccessibleNow(page, `${what}, ${look}`);
    if (screen !== undefined && backend !== 'native') await expectSameScreen(page, screen);
  });
}
