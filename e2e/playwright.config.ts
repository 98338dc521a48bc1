// SPDX-License-Identifier: GPL-3.0-or-later
// FORMWRIGHT_BACKEND=mock | wasm | native chooses what the page solves with; without it, wasm where it is
// built, else mock. The browser is the system's: nothing is downloaded.
import { defineConfig } from '@playwright/test';
import { execSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { resolve } from 'node:path';

const web = resolve(import.meta.dirname, '../web');
const built = existsSync(resolve(web, 'public/wasm/formwright.mjs'));
export const backend = process.env['FORMWRIGHT_BACKEND'] ?? (built ? 'wasm' : 'mock');
process.env['FORMWRIGHT_BACKEND'] = backend; // the tests read it too

const usualPort = { mock: 5631, wasm: 5632, native: 5633 }[backend] ?? 5631;
/** FORMWRIGHT_PORT lets two copies of the repository run their stories at once. */
const port = Number(process.env['FORMWRIGHT_PORT'] ?? usualPort);
const servers: Record<string, { command: string; url: string }> = {
  mock: {
    command: `npx vite build --mode mock --outDir ../e2e/test-results/mock --emptyOutDir && npx vite preview --outDir ../e2e/test-results/mock --port ${port} --strictPort`,
    url: `http://127.0.0.1:${port}`,
  },
  wasm: {
    command: `npx vite build && npx vite preview --port ${port} --strictPort --host 127.0.0.1`,
    url: `http://127.0.0.1:${port}`,
  },
  // Starts the worker with a fresh folder and writes down the address it prints, token and all.
  native: { command: `node ../e2e/start_worker.mjs ${port}`, url: `http://127.0.0.1:${port}` },
};
const server = servers[backend];
if (server === undefined) throw new Error(`FORMWRIGHT_BACKEND is mock, wasm or native, not ${backend}.`);

export default defineConfig({
  testDir: '.',
  outputDir: 'test-results/stories',
  timeout: 180_000,
  expect: { timeout: 60_000 },
  workers: 1, // each page draws with a software WebGL and solves: one after the other
  retries: process.env['CI'] ? 1 : 0, // what fails is reported and asked once more (setup/test.sh)
  reporter: process.env['CI'] ? 'dot' : 'list',
  use: {
    baseURL: server.url,
    viewport: { width: 1280, height: 800 },
    trace: process.env['CI'] ? 'on-first-retry' : 'retain-on-failure', // recording slows the page by a fifth
    launchOptions: {
      executablePath:
        process.env['CHROMIUM'] ??
        execSync('command -v chromium || command -v google-chrome', { encoding: 'utf8' }).trim(),
      args: [
        '--headless=new',
        '--no-sandbox',
        '--disable-quic',
        '--no-first-run',
        '--disable-background-networking',
        '--disable-component-update',
        '--disable-sync',
      ],
    },
  },
  webServer: {
    ...server,
    cwd: web,
    timeout: 120_000,
    reuseExistingServer: false,
    stdout: 'ignore',
    ignoreHTTPSErrors: true,
  },
});
