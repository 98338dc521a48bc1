// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { readGcodePath } from './gcode_path';
import { workBounds } from './toolpath';

const read = (text: string) => readGcodePath(text, [400, 400], 1000);

describe('G-code as a path', () => {
  it('tells work from travel, with times and lines', () => {
    const path = read('G21 G90\nM4 S500\nG0 X10 ; there\nG1 X20 F600\nY10\nM5\nG0 X0 Y0');
    expect(path.paths.map(({ kind }) => kind)).toEqual(['travel', 'work', 'travel']);
    expect(path.paths[1]).toMatchObject({
      power_percent: 50,
      speed_mm_per_s: 10,
      times_s: [0.1, 1.1, 2.1],
      lines: [3, 4, 5],
    });
    expect(workBounds(path)).toEqual([10, 0, 20, 10]);
  });
  it('reads inches, relative moves and arcs', () => {
    expect(workBounds(read('G20\nM3 S1\nG1 X1 F10'))?.[2]).toBeCloseTo(25.4);
    expect(workBounds(read('G91\nM3 S1\nG1 X5 F10\nX5'))?.[2]).toBe(10);
    const half = workBounds(read('G0 X20\nM3 S1\nG3 X0 Y0 I-10 J0 F100'));
    expect(half?.[3]).toBeCloseTo(10, 1);
    expect(half?.[1]).toBeCloseTo(0, 6);
  });
  // The bounds that tests/machines/gcode_program_test.cpp has of the same programs.
  it.each([
    ['G18\nG0X0Y5Z0\nM3S1\nG2X20Z0I10K0F100', [0, 20, 5, 5, -10, 0]],
    ['G19\nG0X1Y0Z0\nM3S1\nG3X4Y20Z0J10K0F100', [1, 4, 0, 20, -10, 0]],
    ['G0X0Y0\nM3S1\nG3X10Y10R-10F100', [0, 20, -10, 10, 0, 0]],
    ['G0X0Y0\rM3S1\rG3X10Y10R10F100', [0, 10, 0, 10, 0, 0]],
  ])('reaches as far as the driver says: %s', (text, bounds) => {
    const points = read(text).paths.flatMap(({ kind, points_mm }) =>
      kind === 'work' ? [Array.from(points_mm)] : [],
    );
    const of = (axis: number) => points.flat().filter((_, index) => index % 3 === axis);
    const found = [0, 1, 2].flatMap((axis) => [Math.min(...of(axis)), Math.max(...of(axis))]);
    found.forEach((value, index) => expect(value).toBeCloseTo(bounds[index] ?? 0, 1));
  });
  it('draws arcs in few points, however large they are said to be', () => {
    const path = read('G0X0Y0\nM3S1\nG2X1Y1I1000000000J0F100');
    const points = path.paths.reduce((sum, { points_mm }) => sum + points_mm.length / 3, 0);
    expect(points).toBeLessThan(1000);
  });
  it('refuses a file without moves', () => {
    expect(() => read('hello\nM5')).toThrow(/no moves/);
  });
});
