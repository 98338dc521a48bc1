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
  it('refuses a file without moves', () => {
    expect(() => read('hello\nM5')).toThrow(/no moves/);
  });
});
