// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import type { CraftResult } from './craft_document';
import { howMade, howMadeItem } from './how_made';

const result = (report: CraftResult['report']): CraftResult => ({
  id: '1',
  made_unix_s: 1_700_000_000,
  backend: 'wasm',
  seconds: 2,
  mesh: 'm',
  parameters: {},
  report,
  outputs: { 'relief.stl': { blob: 'ab', bytes: 84, media_type: 'model/stl' } },
});
const record = { program: 'Formwright', operation: 'relief', job: '0123456789abcdef' };

interface Step {
  readonly made_by: { readonly job: string };
  readonly made: string;
  readonly files: object;
}
const stepsOf = (results: Parameters<typeof howMade>[0]) =>
  (JSON.parse(howMade(results)) as { readonly steps: readonly Step[] }).steps;

it('says job, time and the hash of every file, from the first step on', () => {
  const made = stepsOf([result({ made_by: record }), null, result({ made_by: { job: '2' } })]);
  expect(made.map((step) => step.made_by.job)).toEqual([record.job, '2']);
  expect(made[0]?.made).toBe('2023-11-14T22:13:20.000Z');
  expect(made[0]?.files).toEqual({ 'relief.stl': { sha256: 'ab', bytes: 84 } });
});

it('a result of an earlier version is left out, and alone it says why', () => {
  expect(stepsOf([result({})])).toEqual([]);
  expect(howMadeItem('Cat', result({})).disabledReason).toMatch(/earlier version/);
  expect(howMadeItem('Cat', result({}), result({ made_by: record })).disabledReason).toBeUndefined();
});
