// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { beyondOpening, boxOf, placed, shareThatFits, sizeBeforeTurning_mm } from './placement';

describe('making a model fit', () => {
  // A bar 2 long, turned by 45 degrees and scaled by 100.
  const bar = [-1, -0.1, 0, 1, -0.1, 0, 1, 0.1, 0, -1, 0.1, 0.3];
  const c = 100 * Math.SQRT1_2;
  const m = [c, -c, 0, 0, c, c, 0, 0, 0, 0, 100, 0, 0, 0, 0, 1];
  it('knows the size that the parameter means, however it is turned', () => {
    expect(sizeBeforeTurning_mm(m, boxOf(bar))).toBeCloseTo(200, 9);
  });
  it('leaves 5 mm around it, and keeps what fits', () => {
    const opening = [100, 120] as const;
    const share = shareThatFits(boxOf(placed(bar, m)), opening);
    expect(share).toBeLessThan(1);
    const smaller = boxOf(
      placed(
        bar,
        [...m].map((x) => x * share),
      ),
    );
    expect(smaller.high[0] - smaller.low[0]).toBeCloseTo(90, 4);
    expect(beyondOpening(smaller, [...opening])).toBe(0);
    expect(shareThatFits(boxOf(placed(bar, m)), [400, 400])).toBe(1);
  });
});
