// SPDX-License-Identifier: GPL-3.0-or-later
import fc from 'fast-check';
import { expect, it } from 'vitest';
import { distortionOfParts, partsOfTriangles, VertexGrid } from './part_map';
import { woundDesign } from './test_ribbon';

const coordinate = fc.double({ min: -50, max: 50, noNaN: true });
const points = fc.array(fc.tuple(coordinate, coordinate, coordinate), { minLength: 1, maxLength: 60 });

it('finds the nearest vertex, wherever one asks', () => {
  fc.assert(
    fc.property(points, fc.tuple(coordinate, coordinate, coordinate), (all, asked) => {
      const positions = Float32Array.from(all.flat());
      const off = (v: number) =>
        Math.hypot(...[0, 1, 2].map((k) => (positions[3 * v + k] ?? 0) - (asked[k] ?? 0)));
      const found = new VertexGrid(positions).nearest(asked);
      const least = Math.min(...all.map((_, v) => off(v)));
      expect(off(found)).toBeCloseTo(least, 6);
    }),
  );
});

it('gives each triangle the part below it', () => {
  const { ribbon } = woundDesign(12);
  const segment = Float32Array.from(ribbon.sample, (_, v) =>
    (ribbon.positions[3 * v + 1] ?? 0) > 0 ? 1 : 0,
  );
  const parts = partsOfTriangles(ribbon, segment, new VertexGrid(ribbon.positions));
  expect(parts.length).toBe(24);
  expect(parts[4]).toBe(1); // a quarter turn on: y is positive
  expect(parts[18]).toBe(0); // three quarters
});

/** A right-angled triangle of part 0, and one of part 1 beside it. */
const mesh = (u: number[], v: number[]) => ({
  positions: Float32Array.from([0, 0, 0, 3, 0, 0, 0, 4, 0, 10, 0, 0, 16, 0, 0, 10, 0, 8]),
  indices: Uint32Array.from([0, 1, 2, 3, 4, 5]),
  attributes: {
    u: Float32Array.from(u),
    v: Float32Array.from(v),
    segment: Float32Array.from([0, 0, 0, 1, 1, 1]),
  },
});

it('an isometry is not distorted, twice the length is, by the closed form', () => {
  const parts = distortionOfParts(mesh([0, 3, 0, 0, 12, 0], [0, 0, 4, 0, 0, 8]));
  expect(parts[0]).toEqual({ area_mm2: 6, mean: expect.closeTo(1, 6), most: expect.closeTo(1, 6) });
  // Singular values 2 and 1: (4 + 1 + 1/4 + 1) / 4.
  expect(parts[1]?.mean).toBeCloseTo(1.5625, 6);
  expect(parts[1]?.area_mm2).toBeCloseTo(24, 6);
});

it('turning u and v does not matter', () => {
  const [s, c] = [Math.sin(0.7), Math.cos(0.7)];
  const parts = distortionOfParts(
    mesh([0, 3 * c, -4 * s, 0, 6 * c, -8 * s], [0, 3 * s, 4 * c, 0, 6 * s, 8 * c]),
  );
  for (const part of parts) expect(part.mean).toBeCloseTo(1, 5);
});

it('a mesh without u and v says nothing', () => {
  expect(distortionOfParts({ ...mesh([], []), attributes: {} })).toEqual([]);
});
