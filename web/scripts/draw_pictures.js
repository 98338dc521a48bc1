// SPDX-License-Identifier: GPL-3.0-or-later
// npm run pictures [NAME]: draws the start screen's pictures anew into public/pictures. Needs the WASM
// build and the system's Chromium; run it when a sample or the light changed.
/* global Buffer, console */
import { chromium } from '@playwright/test';
import { execSync } from 'node:child_process';
import { mkdirSync, writeFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { createServer } from 'vite';

const web = resolve(import.meta.dirname, '..');
const server = await createServer({ root: web, server: { port: 5650, strictPort: true, host: '127.0.0.1' } });
await server.listen();
const browser = await chromium.launch({
  executablePath: execSync('command -v chromium || command -v google-chrome', { encoding: 'utf8' }).trim(),
  args: ['--headless=new', '--no-sandbox'],
});
try {
  const page = await browser.newPage();
  await page.goto('http://127.0.0.1:5650/#/about');
  const pictures = await page.evaluate(
    async (only) => (await import('/scripts/in_page/draw_pictures.ts')).drawPictures(only),
    process.argv[2],
  );
  const folder = resolve(web, 'public/pictures');
  mkdirSync(folder, { recursive: true });
  for (const [name, url] of Object.entries(pictures)) {
    const bytes = Buffer.from(url.slice(url.indexOf(',') + 1), 'base64');
    writeFileSync(resolve(folder, `${name}.webp`), bytes);
    console.log(`${name}.webp  ${bytes.length} bytes`);
  }
} finally {
  await browser.close();
  await server.close();
}
