// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import { newDocument } from '../../project/document';
import type { CraftResult } from '../../shared/session/craft_document';
import { subjectOf } from '../../shared/session/craft_document';
import { baseInputs, currentResult, earlierResults, relief, takeBase } from './relief_document';

const blob = (digit: string) => ({ blob: digit.repeat(64), bytes: 1, media_type: 'x' });
const file = { file_name: 'wall.stl', file: blob('b') };
const start = relief
  .command({ label: 'Set' }, () => ({
    parameters: { base: 'groove', width_mm: 80 },
  }))
  .apply(newDocument('', '', 0));

it('a base from a file takes the place of the built-in shapes, and goes again', () => {
  const withFile = relief.of(takeBase(file).apply(start));
  expect(withFile).toMatchObject({ base: file, parameters: { width_mm: 80 } });
  expect(baseInputs(withFile)).toEqual({ base_mesh: { sha256: 'b'.repeat(64), file_name: 'wall.stl' } });
  const without = relief.of(takeBase(null).apply(takeBase(file).apply(start)));
  expect(without.base).toBeNull();
  expect(baseInputs(without)).toEqual({});
});

it('another base begins where its file has it', () => {
  const moved = relief
    .command({ label: 'Move' }, ({ parameters }) => ({ parameters: { ...parameters, base_mesh_x_mm: 7 } }))
    .apply(takeBase(file).apply(start));
  expect(relief.of(moved).parameters).toEqual({ width_mm: 80, base_mesh_x_mm: 7 });
  expect(relief.of(takeBase({ ...file, file_name: 'door.stl' }).apply(moved)).parameters).toEqual({
    width_mm: 80,
  });
  expect(relief.of(takeBase(null).apply(moved)).parameters).toEqual({ width_mm: 80 });
});

it('a result made on one base is not that of another', () => {
  const document = relief.of(start);
  const on = (base: typeof file | null) => subjectOf(blob('a'), 'mesh', baseInputs({ ...document, base }));
  const made = { id: 'one', mesh: on(file).key, parameters: document.parameters } as CraftResult;
  const results = { ...document, results: [made] };
  expect(currentResult(results, on(file))).toBe(made);
  expect(currentResult(results, on(null))).toBeNull();
  expect(currentResult(results, null)).toBeNull();
});

it('an earlier result comes back with its base and what was painted', () => {
  const painting = { on: 'a'.repeat(64), file: blob('c') };
  const made = { id: 'one', mesh: '', parameters: { width_mm: 50 } } as unknown as CraftResult;
  const withResult = relief.addResult(made).apply(takeBase(file).apply(start));
  const painted = relief.command({ label: 'Paint' }, () => ({ painting })).apply(withResult);
  const noted = relief.noteInputs(made, relief.of(painted)).apply(painted);
  const later = relief
    .command({ label: 'Clear' }, () => ({ painting: null }))
    .apply(takeBase(null).apply(noted));
  const [result] = relief.of(later).results;
  if (result === undefined) throw new Error('the result is gone');
  const restored = relief.of(relief.restoreResult(result, 'Restore').apply(later));
  expect(restored).toMatchObject({ base: file, painting, parameters: { width_mm: 50 } });
  // One that an earlier version made says nothing of them: what is there stays.
  const old = relief.of(relief.restoreResult(made, 'Restore').apply(painted));
  expect(old).toMatchObject({ base: file, painting });
});

it('results of the same model on another base are offered once it is known which', () => {
  const document = relief.of(start);
  const on = (base: typeof file | null) => subjectOf(blob('a'), 'mesh', baseInputs({ ...document, base }));
  const result = (id: string, mesh: string, made_with?: object) =>
    ({ id, mesh, parameters: {}, ...(made_with ? { made_with } : {}) }) as unknown as CraftResult;
  const results = [
    result('here', on(file).key),
    result('noted', on(null).key, { base: null, painting: null }),
    result('unknown', on(null).key),
    result('other model', 'd'.repeat(64), { base: null, painting: null }),
  ];
  expect(earlierResults({ ...document, results }, on(file)).map(({ id }) => id)).toEqual(['here', 'noted']);
  expect(earlierResults({ ...document, results }, null)).toEqual([]);
});

it('a project of an earlier version has no base', () => {
  const { base: _, ...old } = relief.of(start);
  const document = { ...start, crafts: { relief: old as never } };
  expect(relief.of(document).base).toBeNull();
});
