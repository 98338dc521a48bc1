// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { RimReading } from './rim';
import { measuredRim, rimIn, rimProblem, rimRows, thicknessIn } from './rim';

const left = (typed: string): RimReading => ({ side: 'left', sheet_mm: [-115, 0], expected_mm: 1, typed });

describe('thickness of the rim', () => {
  it('is read as people write it, and only where it is one', () => {
    expect(thicknessIn(left('0,95'))).toBe(0.95);
    for (const text of ['', '0', '-1', 'thin']) expect(thicknessIn(left(text))).toBeNull();
  });

  it('says what is wrong', () => {
    expect(rimProblem(left(''))).toBe('');
    expect(rimProblem(left('1.12'))).toBe('');
    expect(rimProblem(left('1 mm'))).toContain('“1 mm” is not a thickness');
    expect(rimProblem(left('10'))).toContain('about 1 mm thick');
    expect(rimProblem(left('0.1'))).toContain('about 1 mm thick');
  });

  it('makes rows without a place in space', () => {
    const rim = [left('1.1'), left('')];
    expect(measuredRim(rim)).toHaveLength(1);
    expect(rimRows(rim)).toEqual(['-115,0,,,,,1.1,0']);
  });

  it('reads the places of a report, and nothing of a broken one', () => {
    const place = { side: 'left', sheet_x_mm: -115, sheet_y_mm: 0, expected_mm: 1 };
    expect(rimIn({ rim: [place, { ...place, side: 3 }, 5] })).toEqual([left('')]);
    expect(rimIn({})).toEqual([]);
  });
});
