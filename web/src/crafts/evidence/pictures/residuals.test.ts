// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { Residuals } from './residuals';
import {
  arrowsOf,
  cellSide,
  distancesOf,
  heightDifferenceOf,
  histogram,
  movedBy,
  nearestTo,
  neighbourOf,
  niceDown,
  niceUp,
  percentile,
  readResiduals,
  scaleFor,
  simulatedIn,
  worstRegion,
} from './residuals';

const diagnosed = [
  'object,sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,calibrated_x_mm,calibrated_y_mm,calibrated_z_mm,extended_x_mm,extended_y_mm,extended_z_mm,weight',
  'lamp,-10,0,-10,0,1,-7,4,1,-10,0,1.5,1',
  'lamp,10,0,10,0,1,13,4,1,10,0,1.5,1',
  'bowl,0,0,0,0,5,0,0,7,0,0,5,1',
  '',
].join('\n');

/** A grid of points that a simulation moves by (1, −2, 0.5). */
function grid(side: number): Residuals {
  const places = Array.from({ length: side * side }, (_, i) => [i % side, Math.floor(i / side)] as const);
  return {
    count: places.length,
    sheet: Float64Array.from(places.flat()),
    measured: Float64Array.from(places.flatMap(([x, y]) => [x, y, 3])),
    base: Float64Array.from(places.flatMap(([x, y]) => [x + 1, y - 2, 3.5])),
    extended: null,
  };
}

describe('residuals', () => {
  it('are read by object, with both models', () => {
    const read = readResiduals(diagnosed);
    expect([...read.keys()]).toEqual(['lamp', 'bowl']);
    const lamp = read.get('lamp') as Residuals;
    expect(lamp.count).toBe(2);
    expect([...lamp.sheet]).toEqual([-10, 0, 10, 0]);
    expect([...distancesOf(lamp, 'base')]).toEqual([5, 5]);
    expect([...distancesOf(lamp, 'extended')]).toEqual([0.5, 0.5]);
    expect([...heightDifferenceOf(read.get('bowl') as Residuals, 'base')]).toEqual([2]);
  });

  it('of a comparison have one model, which stands for the other as well', () => {
    const csv =
      'sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,simulated_x_mm,simulated_y_mm,simulated_z_mm,error_mm\n1,2,3,4,5,3,4,6,1\n';
    const read = readResiduals(csv).get('') as Residuals;
    expect(read.extended).toBeNull();
    expect(simulatedIn(read, 'extended')).toBe(read.base);
    expect([...distancesOf(read, 'extended')]).toEqual([1]);
  });

  it('without their columns are refused', () => {
    expect(() => readResiduals('a,b\n1,2\n')).toThrow(/lacks columns/);
  });

  it('count every value once in a histogram, those beyond in the last bin', () => {
    const values = Float64Array.of(0, 0.09, 0.1, 0.55, 0.99, 1, 7);
    const counts = histogram(values, 10, 1);
    expect(counts).toEqual([2, 1, 0, 0, 0, 1, 0, 0, 0, 3]);
    expect(counts.reduce((a, b) => a + b, 0)).toBe(values.length);
    expect(percentile(values, 0.5)).toBe(0.55);
  });

  it('find round numbers', () => {
    expect([0.0012, 0.03, 1, 1.1, 2.2, 70].map(niceUp)).toEqual([0.002, 0.05, 1, 2, 5, 100]);
    expect([0.3, 1, 3, 19, 60].map(niceDown)).toEqual([0.2, 1, 2, 10, 50]);
  });

  it('become one arrow a cell, each the mean of its points', () => {
    const residuals = grid(20);
    const arrows = arrowsOf(residuals, 'base', 5);
    expect(arrows.length).toBeGreaterThanOrEqual(25);
    for (const { dx, dy } of arrows) {
      expect(dx).toBeCloseTo(1, 12);
      expect(dy).toBeCloseTo(-2, 12);
    }
    const lengths = Float64Array.from(arrows, ({ dx, dy }) => Math.hypot(dx, dy));
    const scale = scaleFor(lengths, cellSide(residuals, 5));
    expect(scale * Math.hypot(1, 2)).toBeLessThanOrEqual(cellSide(residuals, 5));
    expect(2.6 * scale * Math.hypot(1, 2)).toBeGreaterThan(cellSide(residuals, 5));
  });

  it('know the nearest point and its neighbours', () => {
    const residuals = grid(5);
    const middle = nearestTo(residuals, 2.2, 1.9);
    expect(middle).toBe(12);
    expect(neighbourOf(residuals, 12, 1, 0)).toBe(13);
    expect(neighbourOf(residuals, 12, 0, 1)).toBe(17);
    expect(neighbourOf(residuals, 0, -1, 0)).toBe(0);
  });

  it('says where the sheet is off most', () => {
    const even = grid(9);
    const at = (column: number, row: number): Residuals => ({
      ...even,
      base: Float64Array.from(even.base, (value, i) => {
        const point = Math.floor(i / 3);
        const here = Math.floor((point % 9) / 3) === column && Math.floor(Math.floor(point / 9) / 3) === row;
        return i % 3 === 2 && here ? 9 : value;
      }),
    });
    expect(worstRegion(at(0, 0), 'base')?.where).toBe('at the front left');
    expect(worstRegion(at(2, 1), 'base')?.where).toBe('on the right');
    expect(worstRegion(at(1, 1), 'base')?.where).toBe('in the middle');
    expect(worstRegion(at(1, 2), 'base')?.where).toBe('at the back');
    expect(worstRegion(at(2, 2), 'base')?.mean_mm).toBeCloseTo(Math.hypot(1, 2, 6), 6);
    expect(worstRegion(grid(2), 'base')).toBeNull();
  });

  it('says how far a cause moves the points', () => {
    expect(movedBy(grid(3))).toBeNull();
    const base = grid(2);
    const extended = Float64Array.from(base.base, (value, i) => (i === 0 ? value + 4 : value));
    expect(movedBy({ ...base, extended })).toEqual({ mean_mm: 1, largest_mm: 4 });
  });
});
