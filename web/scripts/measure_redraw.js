// SPDX-License-Identifier: GPL-3.0-or-later
// npm run redraw: how long the built page takes from a new number of windings to the ribbon drawn anew, as JSON.
// Needs web/dist (make web). The smallest, median and largest of twenty changes, on every sample's preview.
/* global console, document, performance, requestAnimationFrame, MutationObserver, Event, KeyboardEvent */
import { chromium } from '@playwright/test';
import { execSync } from 'node:child_process';
import { loadavg } from 'node:os';
import { resolve } from 'node:path';
import { preview } from 'vite';

const server = await preview({
  root: resolve(import.meta.dirname, '..'),
  preview: { port: 5652, strictPort: true, host: '127.0.0.1' },
});
const browser = await chromium.launch({
  executablePath: execSync('command -v chromium || command -v google-chrome', { encoding: 'utf8' }).trim(),
  args: ['--headless=new', '--no-sandbox'],
});

/** In the page: sets the number and waits until the seam under the flat ribbon says another length, and the frame after it. */
const change = async (input, windings) => {
  const foot = document.querySelector('.flat-foot');
  const before = foot.textContent;
  const changed = new Promise((done) => {
    const observer = new MutationObserver(() => {
      if (foot.textContent === before) return;
      observer.disconnect();
      requestAnimationFrame(() => requestAnimationFrame(done));
    });
    observer.observe(foot, { subtree: true, childList: true, characterData: true });
  });
  const start = performance.now();
  input.focus();
  input.value = windings;
  input.dispatchEvent(new Event('input', { bubbles: true }));
  input.dispatchEvent(new KeyboardEvent('keydown', { key: 'Enter', bubbles: true }));
  input.dispatchEvent(new Event('change', { bubbles: true }));
  await changed;
  return performance.now() - start;
};

const results = [];
try {
  // The gallery's order.
  for (const [place, title] of ['Star', 'Heart', 'T', 'Octopus', 'Cat', 'Torus'].entries()) {
    const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
    await page.goto('http://127.0.0.1:5652/');
    await page.getByRole('link', { name: 'Zippable', exact: true }).click();
    await page.locator('.gallery button').nth(place).click();
    await page.locator('footer').getByText('Preview up to date').first().waitFor({ timeout: 120_000 });
    const field = page.getByRole('textbox', { name: 'Windings', exact: true });
    const times = [];
    for (let i = 0; i < 20; ++i) {
      times.push(await field.evaluate(change, String([3, 4, 5, 4][i % 4])));
      await page.locator('footer').getByText('Preview up to date').first().waitFor();
    }
    times.sort((a, b) => a - b);
    const [least, median, most] = [times[0], times[10], times[19]].map(Math.round);
    results.push({ sample: title, least_ms: least, median_ms: median, most_ms: most });
    console.error(`${title.padEnd(8)} ${least} ${median} ${most} ms`);
    await page.close();
  }
} finally {
  await browser.close();
  await server.close();
}
console.log(JSON.stringify({ bench: 'redraw', load: loadavg()[0], results }, null, 1));
