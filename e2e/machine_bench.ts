// SPDX-License-Identifier: GPL-3.0-or-later
// What the stories with a cable share: a browser that was started under umockdev, and what it is allowed without a chooser.
import type { Browser, Page } from '@playwright/test';
import { chromium } from '@playwright/test';
import { spawnSync } from 'node:child_process';
import { mkdirSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { join } from 'node:path';
import { expect } from './page';

const policies = '/etc/chromium/policies/managed';
const policy = join(policies, 'formwright_test.json');

/** Stands in for the browser's own chooser, until `forbid`. */
export function allow(what: object): void {
  mkdirSync(policies, { recursive: true });
  writeFileSync(policy, JSON.stringify(what));
}
export const forbid = (): void => {
  rmSync(policy, { force: true });
};

export const hasUmockdev = (): boolean => spawnSync('umockdev-run', ['--version']).status === 0;

async function freePort(): Promise<number> {
  const server = createServer();
  await new Promise<void>((done) => server.listen(0, '127.0.0.1', done));
  const { port } = server.address() as { port: number };
  await new Promise((done) => server.close(done));
  return port;
}

/** umockdev hands no pipes on: the browser is spoken to over its debugging port. `start` is given the browser and its flags. */
export async function browserOf(
  folder: string,
  start: (words: readonly string[]) => void,
): Promise<{ browser: Browser; page: Page }> {
  const debugging = await freePort();
  start([
    process.env['CHROMIUM'] ?? 'chromium',
    '--headless=new',
    '--no-sandbox',
    '--disable-gpu',
    '--no-first-run',
    '--disable-background-networking',
    `--remote-debugging-port=${debugging}`,
    `--user-data-dir=${join(folder, 'profile')}`,
    'about:blank',
  ]);
  await expect
    .poll(
      () =>
        fetch(`http://127.0.0.1:${debugging}/json/version`).then(
          (answer) => answer.ok,
          () => false,
        ),
      { timeout: 30_000 },
    )
    .toBe(true);
  const browser = await chromium.connectOverCDP(`http://127.0.0.1:${debugging}`);
  const context = browser.contexts()[0];
  if (context === undefined) throw new Error('The browser has no context.');
  return { browser, page: await context.newPage() };
}

export const plate = `<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="40mm" viewBox="0 0 60 40">
<g id="cut" stroke="#ff0000" fill="none"><rect x="5" y="5" width="50" height="30"/><circle cx="30" cy="20" r="8"/></g></svg>`;

export const chip = (page: Page, words: string | RegExp) => page.locator('.state-chip').getByText(words);
export const confirm = (page: Page, name: string) =>
  page.getByRole('dialog').getByRole('button', { name, exact: true }).click();
