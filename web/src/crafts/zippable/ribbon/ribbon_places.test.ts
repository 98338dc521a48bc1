// SPDX-License-Identifier: GPL-3.0-or-later
import fc from 'fast-check';
import { expect, it } from 'vitest';
import { alongAt, flatOf, placeInFlat, placeInSpace, positionOf, seamAt } from './ribbon_places';
import { woundDesign } from './test_ribbon';

const design = woundDesign(12);
const { ribbon } = design;
const inside = fc.record({
  triangle: fc.integer({ min: 0, max: 23 }),
  a: fc.double({ min: 0.01, max: 0.98, noNaN: true }),
  b: fc.double({ min: 0.01, max: 0.98, noNaN: true }),
});
/** Weights that sum to 1 and are all positive. */
const weightsOf = (a: number, b: number): [number, number, number] => {
  const sum = a + b + 0.5;
  return [a / sum, b / sum, 0.5 / sum];
};

it('finds a place of the plane again', () => {
  fc.assert(
    fc.property(inside, ({ triangle, a, b }) => {
      const place = { triangle, weights: weightsOf(a, b) };
      const [x, y] = flatOf(ribbon, place);
      const found = placeInFlat(ribbon, x, y);
      expect(found).not.toBeNull();
      const again = found ? flatOf(ribbon, found) : [NaN, NaN];
      expect(again[0]).toBeCloseTo(x, 3);
      expect(again[1]).toBeCloseTo(y, 3);
    }),
  );
});

it('finds a place in space again, also of a bent ribbon', () => {
  const shifted = ribbon.positions.map((value, i) => (i % 3 === 0 ? value + 7 : value));
  fc.assert(
    fc.property(inside, fc.boolean(), ({ triangle, a, b }, moved) => {
      const positions = moved ? shifted : ribbon.positions;
      const point = positionOf(ribbon, { triangle, weights: weightsOf(a, b) }, positions);
      const found = placeInSpace(ribbon, point, positions);
      expect(found?.triangle).toBe(triangle);
      const again = found ? positionOf(ribbon, found, positions) : [NaN, NaN, NaN];
      again.forEach((value, k) => expect(value).toBeCloseTo(point[k] ?? NaN, 3));
    }),
  );
});

it('takes the nearest place for a point beside the ribbon, and none in the plane', () => {
  // No triangle has a point nearer than the one found, on a fine grid of weights.
  fc.assert(
    fc.property(
      fc.array(fc.double({ min: -60, max: 60, noNaN: true }), { minLength: 3, maxLength: 3 }),
      (p) => {
        const point = p as [number, number, number];
        const off = (q: readonly number[]) => Math.hypot(...q.map((value, k) => value - (point[k] ?? 0)));
        const place = placeInSpace(ribbon, point);
        const found = place ? off(positionOf(ribbon, place)) : NaN;
        for (let triangle = 0; triangle < 24; ++triangle)
          for (let i = 0; i <= 6; ++i)
            for (let j = 0; i + j <= 6; ++j) {
              const weights = [i / 6, j / 6, 1 - (i + j) / 6] as const;
              expect(off(positionOf(ribbon, { triangle, weights }))).toBeGreaterThan(found - 1e-4);
            }
      },
    ),
    { numRuns: 40 },
  );
  expect(placeInFlat(ribbon, -500, 0)).toBeNull();
});

it('brings the two sides of the seam together', () => {
  const places = seamAt(design, design.zipper_mm / 2);
  expect(places).toHaveLength(2);
  for (const place of places) expect(alongAt(design, place)).toBeCloseTo(design.zipper_mm / 2, 3);
  const flats = places.map((place) => flatOf(ribbon, place));
  expect(
    Math.hypot((flats[0]?.[0] ?? 0) - (flats[1]?.[0] ?? 0), (flats[0]?.[1] ?? 0) - (flats[1]?.[1] ?? 0)),
  ).toBeCloseTo(10, 3);
});
