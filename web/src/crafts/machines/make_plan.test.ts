// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { carvedOf } from './make_plan';

const outputs = { 'carved.ply': { blob: 'carved', bytes: 1, media_type: 'model/ply' } };
const parameters = { x_mm: 12, y_mm: 7, stock_over_mm: 0.5 };

describe('the surface that a mill leaves', () => {
  it('lies where the tool runs: the stock’s top at zero, its corner where the job begins', () => {
    const { carved } = carvedOf({ outputs, report: { size_mm: [40, 30, 5] } }, parameters);
    const [x, y, z] = carved?.offset_mm ?? [];
    expect([x, y]).toEqual([12, 7]);
    // The model's highest place is on a plate of 2 mm, and under 0.5 mm of stock.
    expect(2 + 5 + (z ?? 0)).toBeCloseTo(-0.5, 12);
  });

  it('is not there for a job that was made without it', () => {
    expect(carvedOf({ outputs: {}, report: { size_mm: [40, 30, 5] } }, parameters)).toEqual({});
  });
});
