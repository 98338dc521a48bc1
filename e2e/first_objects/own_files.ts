// SPDX-License-Identifier: GPL-3.0-or-later
// Files that a maker could have: small, made by code.
import type { Page } from '@playwright/test';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { crc32, deflateSync } from 'node:zlib';
import { ballObj, expect, fileOf, goToRoom, openPage, strip } from '../page';

export type OwnFile = ReturnType<typeof fileOf>;

/** Two units wide, in no unit of length. */
export const ball: OwnFile = fileOf('ball.obj', ballObj());
/** 80 mm wide: its ribbon is cut from one sheet. */
export const smallBall: OwnFile = fileOf(
  'ball.obj',
  ballObj().replaceAll(/^v .*$/gm, (line) =>
    line.replaceAll(/-?\d[\d.e-]*/g, (number) => String(40 * Number(number))),
  ),
);
export const wrongFile: OwnFile = fileOf('notes.obj', 'this is no model');

function chunk(name: string, content: Buffer): Buffer {
  const named = Buffer.concat([Buffer.from(name, 'latin1'), content]);
  const [length, check] = [Buffer.alloc(4), Buffer.alloc(4)];
  length.writeUInt32BE(content.length);
  check.writeUInt32BE(crc32(named));
  return Buffer.concat([length, named, check]);
}

/** Stripes in two colours, as PNG. */
function stripes(size: number): Buffer {
  const header = Buffer.from([0, 0, 0, 0, 0, 0, 0, 0, 8, 2, 0, 0, 0]); // 8 bits, red, green and blue
  header.writeUInt32BE(size, 0);
  header.writeUInt32BE(size, 4);
  const rows = Buffer.alloc(size * (1 + 3 * size)); // each row begins with its filter: none
  for (let y = 0; y < size; ++y)
    for (let x = 0; x < size; ++x)
      rows.set(Math.floor(x / 8) % 2 ? [200, 40, 40] : [30, 60, 160], y * (1 + 3 * size) + 1 + 3 * x);
  const signature = Buffer.from('\x89PNG\r\n\x1a\n', 'latin1');
  return Buffer.concat([
    signature,
    chunk('IHDR', header),
    chunk('IDAT', deflateSync(rows)),
    chunk('IEND', Buffer.alloc(0)),
  ]);
}

/** A hill of unit size with a picture on it: model, material and picture. */
export function paintedHill(n = 24): readonly OwnFile[] {
  const lines = ['mtllib hill.mtl', 'usemtl stripes'];
  for (let j = 0; j <= n; ++j)
    for (let i = 0; i <= n; ++i) {
      const [x, z] = [i / n - 0.5, j / n - 0.5];
      const share = Math.min(1, 4 * (x * x + z * z));
      lines.push(`v ${x} ${0.3 * (1 - share) ** 2} ${z}`, `vt ${i / n} ${1 - j / n}`);
    }
  for (let j = 0; j < n; ++j)
    for (let i = 0; i < n; ++i) {
      const a = j * (n + 1) + i + 1;
      const [b, c, d] = [a + 1, a + n + 2, a + n + 1];
      lines.push(`f ${a}/${a} ${d}/${d} ${c}/${c}`, `f ${a}/${a} ${c}/${c} ${b}/${b}`);
    }
  return [
    fileOf('hill.obj', lines.join('\n')),
    fileOf('hill.mtl', 'newmtl stripes\nmap_Kd stripes.png\n'),
    { name: 'stripes.png', mimeType: 'image/png', buffer: Buffer.from(stripes(64)) },
  ];
}

/** Unpacks an archive; its files by name. */
function unpacked(archive: string, folder: string): ReadonlyMap<string, Buffer> {
  execFileSync('/usr/bin/python3', ['-m', 'zipfile', '-e', archive, folder]);
  const names = readdirSync(folder, { recursive: true, withFileTypes: true });
  return new Map(
    names
      .filter((entry) => entry.isFile())
      .map(({ name, parentPath }) => [name, readFileSync(join(parentPath, name))]),
  );
}

/** mould.obj, setup.json and measured.csv of a virtual pyramid that was colder towards the right: made in the page, taken out of a saved project. */
export async function measuredPyramid(page: Page): Promise<readonly OwnFile[]> {
  await openPage(page);
  await goToRoom(page, 'Evidence');
  await page.getByRole('button', { name: 'Try a virtual object' }).click();
  const dialog = page.getByRole('dialog', { name: 'Make a virtual object' });
  await dialog.getByRole('textbox', { name: 'Points', exact: true }).fill('300');
  await dialog.getByRole('textbox', { name: 'Points', exact: true }).press('Tab');
  await dialog.getByRole('button', { name: 'Make the virtual object' }).click();
  await expect(strip(page, 'Compared with the settings as they are')).toBeVisible({ timeout: 120_000 });
  await page.getByRole('banner').locator('[aria-haspopup=menu]').first().click();
  const saving = page.waitForEvent('download');
  await page.getByRole('menuitem', { name: 'Save as a file' }).click();
  const folder = mkdtempSync(join(tmpdir(), 'formwright-measured-'));
  try {
    const blobs = unpacked(await (await saving).path(), join(folder, 'project'));
    for (const [name, bytes] of blobs) {
      if (bytes.toString('latin1', 0, 2) !== 'PK') continue;
      const found = unpacked(join(folder, 'project', 'blobs', name), join(folder, name));
      const files = ['mould.obj', 'setup.json', 'measured.csv'].map((wanted) => {
        const content = found.get(wanted);
        if (content === undefined) throw new Error(`The virtual object has no ${wanted}.`);
        return fileOf(wanted, content.toString());
      });
      return files;
    }
    throw new Error('The project has no measured object.');
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
}
