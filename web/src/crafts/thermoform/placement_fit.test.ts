// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { fitting } from './fit';
import { boxOf, clearance_mm, placed, shareThatFits } from './placement';
import { margin_mm, placeModel } from './stand/place_model';

/** A bar 2 long. */
const bar = [-1, -0.1, 0, 1, -0.1, 0, 1, 0.1, 0, -1, 0.1, 0.3];
const values = {
  ...{ up: [0, 0, 1], turn_deg: 45, size_mm: 200, x_mm: 30, y_mm: 0, sink_mm: 0 },
  ...{ clamp_opening_x_mm: 100, clamp_opening_y_mm: 120, clamp_slip_mm: 0 },
};
const boxWith = (changed: object) =>
  boxOf(placed(bar, placeModel({ ...values, ...changed }, bar)?.matrix ?? []));

describe('making a model fit', () => {
  it('knows by how much, and keeps what fits', () => {
    const share = shareThatFits(boxWith({}), [100, 120]);
    expect(share).toBeLessThan(1);
    const smaller = boxWith({ size_mm: 200 * share });
    expect(smaller.high[0] - smaller.low[0]).toBeCloseTo(90, 4);
    expect(shareThatFits(boxWith({}), [400, 400])).toBe(1);
  });

  it('leaves 5 mm around it, however it is turned, set by hand or automatic', () => {
    const turns = [
      { turn_deg: 0 },
      { turn_deg: 45 },
      { turn_deg: 90 },
      { up: [0.3, 0.8, 0.4] },
      { up: [1, 0, 0] },
    ];
    for (const turn of turns)
      for (const size_mm of [200, 500, null])
        for (const clamp_slip_mm of [0, 8]) {
          const start = { ...values, ...turn, size_mm, clamp_slip_mm };
          const fit = fitting(start, bar) ?? expect.fail('not placed');
          const room = [100 - 2 * clamp_slip_mm, 120 - 2 * clamp_slip_mm] as const;
          expect(clearance_mm(boxWith({ ...start, ...fit }), room)).toBeGreaterThanOrEqual(margin_mm - 1e-4);
        }
  });

  it('moves what is small enough to the middle, as large as it is', () => {
    const start = { ...values, size_mm: 40 };
    expect(fitting(start, bar)).toEqual({ x_mm: 0, y_mm: 0 });
  });
});
