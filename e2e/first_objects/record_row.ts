// SPDX-License-Identifier: GPL-3.0-or-later
// A row of the table "task × actions × time": its limit, and what a story measured for it (docs/page.md, "First objects").
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { expect } from '../page';
import type { ActionCount } from './actions';

interface Row {
  readonly row: string;
  readonly max_actions: number;
}
const rows = JSON.parse(readFileSync(resolve(import.meta.dirname, 'rows.json'), 'utf8')) as readonly Row[];
const folder = resolve(import.meta.dirname, '../test-results/actions');

/** Writes the row down for write_table.js, and fails where it took more actions than it once did. */
export async function recordRow(row: string, counter: ActionCount): Promise<void> {
  const limit = rows.find((one) => one.row === row)?.max_actions;
  if (limit === undefined) throw new Error(`rows.json has no row ${row}.`);
  const { actions, seconds } = await counter.end();
  mkdirSync(folder, { recursive: true });
  writeFileSync(resolve(folder, `${row}.json`), JSON.stringify({ row, seconds, actions }, null, 1));
  const listed = actions.map(({ kind, what }) => `${kind}: ${what}`);
  expect(listed.length, `${row}: ${listed.join('; ')}`).toBeLessThanOrEqual(limit);
}
