// SPDX-License-Identifier: GPL-3.0-or-later
// The built page below a path of a plain file server, which sends no isolation headers.
import { existsSync, readFileSync, statSync } from 'node:fs';
import { createServer, type Server } from 'node:http';
import type { AddressInfo } from 'node:net';
import { extname, join, resolve, sep } from 'node:path';
import { backend, chooseSample, expect, solve, strip, test } from './page';

const dist = resolve(import.meta.dirname, '../web/dist');
const folder = '/tools/3d/form/';
const mediaTypes: Record<string, string> = {
  '.css': 'text/css',
  '.html': 'text/html',
  '.js': 'text/javascript',
  '.mjs': 'text/javascript',
  '.svg': 'image/svg+xml',
  '.wasm': 'application/wasm',
};
const notFound: string[] = [];
let server: Server;
let address = '';

/** The file that a request asks for, or null. */
function fileAt(path: string): string | null {
  if (!path.startsWith(folder)) return null;
  const file = join(dist, path.slice(folder.length) || 'index.html');
  return file.startsWith(dist + sep) && existsSync(file) && statSync(file).isFile() ? file : null;
}

test.skip(backend !== 'wasm', 'only the page that solves in the browser needs no server of its own');

test.beforeAll(async () => {
  server = createServer((request, response) => {
    const path = decodeURIComponent(new URL(request.url ?? '/', 'http://localhost').pathname);
    const file = fileAt(path);
    if (file === null) {
      notFound.push(path);
      response.writeHead(404).end();
      return;
    }
    response.writeHead(200, { 'Content-Type': mediaTypes[extname(file)] ?? 'application/octet-stream' });
    response.end(request.method === 'HEAD' ? undefined : readFileSync(file));
  });
  await new Promise<void>((done) => server.listen(0, '127.0.0.1', done));
  address = `http://127.0.0.1:${(server.address() as AddressInfo).port}${folder}`;
});

test.afterAll(() => {
  server.closeAllConnections();
  server.close();
});

test('the page works below any path of a plain file server, and afterwards without it', async ({
  page,
  context,
}) => {
  const elsewhere: string[] = [];
  page.on('request', (request) => {
    if (/^https?:/.test(request.url()) && !request.url().startsWith(address)) elsewhere.push(request.url());
  });
  const preview = async () => {
    await chooseSample(page, 'Torus');
  };
  await page.goto(address);
  // Nothing isolates the first visit: it solves without shared memory and has nothing to warn of.
  expect(await page.evaluate(() => crossOriginIsolated)).toBe(false);
  await preview();
  await solve(page);
  const alerts = await page.getByRole('alert').allInnerTexts();
  expect(alerts.filter((text) => text !== '')).toEqual([]);
  await expect(page.getByText('Saved', { exact: true })).toBeVisible();

  // Later visits are answered by the service worker, with the headers.
  await page.evaluate(() => navigator.serviceWorker.ready.then(() => undefined));
  await page.reload();
  await expect.poll(() => page.evaluate(() => crossOriginIsolated)).toBe(true);
  await expect(strip(page, 'Relief ready')).toBeVisible();
  expect(notFound).toEqual([]);

  server.closeAllConnections();
  server.close();
  await context.setOffline(true);
  await page.goto(`${address}index.html`);
  await expect(strip(page, 'Relief ready')).toBeVisible();
  await page.getByRole('link', { name: 'Formwright, start' }).click();
  await preview();
  await solve(page);
  expect(elsewhere).toEqual([]);
});
