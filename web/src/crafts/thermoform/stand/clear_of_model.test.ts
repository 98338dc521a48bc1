// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { clearOf } from './clear_of_model';

const middle = { xPx: 100, yPx: 200 };

describe('a handle beside a small model', () => {
  it('is moved out in its own direction', () => {
    const at = clearOf(middle, { xPx: 103, yPx: 196 }, 50);
    expect(at.xPx).toBeCloseTo(130, 9);
    expect(at.yPx).toBeCloseTo(160, 9);
  });

  it('stays where it is far enough away, or has no direction', () => {
    for (const at of [{ xPx: 160, yPx: 200 }, middle]) expect(clearOf(middle, at, 50)).toEqual(at);
  });
});
