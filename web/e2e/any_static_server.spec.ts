// SPDX-License-Identifier: GPL-3.0-or-later
// web/dist below a path of a plain file server, which knows nothing of isolation headers.
import { spawn, type ChildProcess } from 'node:child_process';
import { mkdirSync, mkdtempSync, rmSync, symlinkSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { backend, expect, solve, strip, test } from './page';

const web = resolve(import.meta.dirname, '..');
let folder = '';
let server: ChildProcess | undefined;
let origin = '';

test.skip(backend !== 'wasm', 'The built page is on trial, which solves in the browser.');

test.beforeAll(async () => {
  folder = mkdtempSync(join(tmpdir(), 'formwright-static-'));
  mkdirSync(join(folder, 'tools/3d'), { recursive: true });
  symlinkSync(join(web, 'dist'), join(folder, 'tools/3d/form'));
  const started = spawn(
    'python3',
    ['-u', '-m', 'http.server', '0', '--bind', '127.0.0.1', '--directory', folder],
    { stdio: ['ignore', 'pipe', 'ignore'] },
  );
  server = started;
  origin = await new Promise((found, failed) => {
    started.on('error', failed);
    started.stdout.on('data', (text) => {
      const address = /http:\/\/127\.0\.0\.1:\d+/.exec(String(text))?.[0];
      if (address) found(address);
    });
  });
});

test.afterAll(() => {
  server?.kill();
  rmSync(folder, { recursive: true, force: true });
});

test('the page works below any path of a plain file server, also without it', async ({ page, context }) => {
  const address = `${origin}/tools/3d/form/`;
  test.setTimeout(600_000); // three visits
  const strangers: string[] = [];
  page.on('request', (request) => {
    if (/^https?:/.test(request.url()) && !request.url().startsWith(address)) strangers.push(request.url());
  });
  await page.goto(address);
  // On the first visit nothing isolates the page: a stop ends the solver's thread.
  expect(await page.evaluate(() => crossOriginIsolated)).toBe(false);
  await page.locator('.gallery button', { hasText: 'Torus' }).click();
  await expect(strip(page, 'Preview up to date')).toBeVisible({ timeout: 150_000 });
  await solve(page);
  // The service worker, once installed, answers with the headers.
  await page.evaluate(() => navigator.serviceWorker.ready.then(() => undefined));
  await page.reload();
  await expect.poll(() => page.evaluate(() => crossOriginIsolated)).toBe(true);
  await expect(strip(page, 'Relief ready').or(strip(page, 'Preview up to date'))).toBeVisible();
  await context.setOffline(true);
  await page.goto(`${address}index.html`);
  await solve(page);
  expect(strangers).toEqual([]);
});
