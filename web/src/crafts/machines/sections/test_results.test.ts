// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { Catalog } from '../../../jobs/contract';
import { findOperation } from '../../../jobs/contract';
import { practiceLaser } from '../../../machines/profiles';
import catalogJson from '../../../../../tests/job/catalog.json';
import { carriedOver, operationFor, pictureSize } from '../machines_document';
import { cellAt, cellsOf, materialInForce, materialNames, profileWith, settingsOf } from './test_results';

const catalog = catalogJson as unknown as Catalog;
const operation = (name: string) => {
  const found = findOperation(catalog, name);
  if (found === undefined) throw new Error(`No operation ${name}.`);
  return found;
};
const [laser, grid, mill] = ['laser-job', 'test-grid', 'mill-job'].map(operation) as [
  ReturnType<typeof operation>,
  ReturnType<typeof operation>,
  ReturnType<typeof operation>,
];

const square = { name: 'R1C1', power_percent: 20, speed_mm_per_s: 5, z_mm: 0, x_mm: 30, y_mm: 10 };

describe('what a test tells', () => {
  const cells = cellsOf({
    cells: [
      square,
      { name: 'R1C2', power_percent: 40, speed_mm_per_s: 5, z_mm: 0, x_mm: 42, y_mm: 10 },
      'damaged',
    ],
  });

  it('is found under a place of the bed', () => {
    expect(cells).toHaveLength(2);
    expect(cellAt(cells, 8, 45, 12)?.name).toBe('R1C2');
    expect(cellAt(cells, 8, 40, 12)).toBeUndefined(); // between the two
  });

  it('sets parameters that the laser’s jobs have', () => {
    const found = settingsOf(cells[1] ?? square, 'mark', 2);
    expect(found).toEqual({ mark_power_percent: 40, mark_speed_mm_per_s: 5, mark_passes: 2 });
    for (const layer of ['cut', 'mark', 'engrave'] as const)
      for (const name of Object.keys(settingsOf(square, layer, 1)))
        expect(materialNames(laser)).toContain(name);
    expect(materialNames(laser)).toContain('kerf_mm');
    expect(materialNames(laser)).not.toContain('x_mm');
  });

  it('goes into the kept material that is in force, and into no other', () => {
    const felt = { name: 'Felt', parameters: { cut_power_percent: 60, kerf_mm: 0.1 } };
    const card = { name: 'Card', parameters: { cut_power_percent: 30, kerf_mm: 0.1 } };
    const profile = { ...practiceLaser, materials: [felt, card] };
    expect(materialInForce(profile, laser, { cut_power_percent: 30 })).toBe(card);
    const after = profileWith(profile, laser, { cut_power_percent: 30 }, { kerf_mm: 0.2 });
    expect(after?.materials).toEqual([
      felt,
      { name: 'Card', parameters: { cut_power_percent: 30, kerf_mm: 0.2 } },
    ]);
    expect(profileWith(profile, laser, {}, { kerf_mm: 0.2 })).toBeNull();
  });
});

describe('parameters follow the operation', () => {
  it('takes the machine along and leaves the rest', () => {
    const before = { bed_x_mm: 600, cut_power_percent: 55, x_mm: 30 };
    expect(carriedOver(laser, before, grid, { columns: 3 })).toEqual({ bed_x_mm: 600, columns: 3 });
    // Back to the default since: the own value of the last time is old.
    expect(carriedOver(laser, {}, grid, { bed_x_mm: 600 })).toEqual({});
  });

  it('leaves a mill its own speed and dialect where none was set', () => {
    expect(carriedOver(laser, {}, mill, { travel_speed_mm_per_s: 20 })).toEqual({
      travel_speed_mm_per_s: 20,
    });
    expect(carriedOver(laser, { controller: 'grbl_mill', bed_x_mm: 300 }, mill, {})).toEqual({
      bed_x_mm: 300,
    });
    expect(carriedOver(mill, { bed_x_mm: 300 }, laser, { controller: 'grbl_mill' })).toEqual({
      bed_x_mm: 300,
      controller: 'grbl_mill',
    });
  });

  it('is known by what is worked on', () => {
    const file = { blob: '', bytes: 0, media_type: '' };
    expect(operationFor(null)).toBe('laser-job');
    expect(operationFor({ kind: 'test', file_name: '', instead_of: null })).toBe('test-grid');
    expect(operationFor({ kind: 'model', file_name: '', file })).toBe('mill-job');
  });

  it('reads a picture’s size from its header', () => {
    const png = Uint8Array.of(
      0x89,
      0x50,
      0x4e,
      0x47,
      13,
      10,
      26,
      10,
      0,
      0,
      0,
      13,
      73,
      72,
      68,
      82,
      0,
      0,
      2,
      0,
      0,
      0,
      1,
      44,
    );
    expect(pictureSize(png)).toEqual([512, 300]);
    expect(pictureSize(new TextEncoder().encode('solid something that is longer'))).toBeNull();
  });
});
