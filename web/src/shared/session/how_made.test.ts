// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import type { CraftModel, CraftResult } from './craft_document';
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
const stepsOf = (results: Parameters<typeof howMade>[1], model: CraftModel | null = null) =>
  (JSON.parse(howMade(model, results)) as { readonly steps: readonly Step[] }).steps;

it('says job, time and the hash of every file, from the first step on', () => {
  const made = stepsOf([result({ made_by: record }), null, result({ made_by: { job: '2' } })]);
  expect(made.map((step) => step.made_by.job)).toEqual([record.job, '2']);
  expect(made[0]?.made).toBe('2023-11-14T22:13:20.000Z');
  expect(made[0]?.files).toEqual({ 'relief.stl': { sha256: 'ab', bytes: 84 } });
});

it('a result of an earlier version is left out, and alone it says why', () => {
  expect(stepsOf([result({})])).toEqual([]);
  expect(howMadeItem('Cat', null, result({})).disabledReason).toMatch(/earlier version/);
  expect(howMadeItem('Cat', null, result({}), result({ made_by: record })).disabledReason).toBeUndefined();
});

it('begins with the reading of the model, which names the file', () => {
  const mesh = { blob: 'cd', bytes: 9, media_type: 'application/x-ply' };
  const source = { kind: 'file', file_name: 'cat.obj', file: mesh } as const;
  const read = { source, mesh, preview: mesh, report: { made_by: { job: '0' } } };
  const made = stepsOf([result({ made_by: record })], read);
  expect(made.map((step) => step.made_by.job)).toEqual(['0', record.job]);
  expect(made[0]?.files).toEqual({ 'model.ply': { sha256: 'cd', bytes: 9 } });
});
