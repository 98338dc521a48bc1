// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { FlatSide, Vec3 } from '../api';
import { findFlatSides } from './flat_sides';

const dot = (a: Vec3, b: Vec3) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const minus = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const cross = (a: Vec3, b: Vec3): Vec3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

/** Twice the area that an outline encloses, as a vector along its normal. */
function doubleArea({ outline }: FlatSide): Vec3 {
  let sum: Vec3 = [0, 0, 0];
  outline.forEach((a, i) => {
    const c = cross(a, outline[(i + 1) % outline.length] ?? a);
    sum = [sum[0] + c[0], sum[1] + c[1], sum[2] + c[2]];
  });
  return sum;
}

/** A box of 2 x 4 x 6 with points all over its surface and inside. */
function boxPoints(): number[] {
  const points: number[] = [];
  for (const u of [-1, -0.4, 0.3, 1])
    for (const v of [-1, 0.1, 1]) for (const w of [-1, -0.2, 0.6, 1]) points.push(u, 2 * v, 3 * w);
  return [...points, 0, 0, 2.5];
}

/** Evenly over a unit sphere. */
const spherePoints = (count: number): Float32Array =>
  Float32Array.from(
    Array.from({ length: count }, (_, i) => {
      const z = 1 - (2 * i + 1) / count;
      const [r, a] = [Math.sqrt(1 - z * z), i * Math.PI * (3 - Math.sqrt(5))];
      return [r * Math.cos(a), r * Math.sin(a), z];
    }).flat(),
  );

describe('the flat sides of a hull', () => {
  it('are the six of a box, the largest first, each in one piece', () => {
    const sides = findFlatSides(boxPoints());
    expect(sides.map(({ area }) => Number(area.toFixed(9)))).toEqual([24, 24, 12, 12, 8, 8]);
    for (const side of sides) {
      const twice = doubleArea(side);
      expect(Math.hypot(...twice) / 2).toBeCloseTo(side.area, 9);
      // Outwards, and counter-clockwise to who looks at it from outside.
      expect(dot(twice, side.normal) / 2).toBeCloseTo(side.area, 9);
      expect(dot(side.normal, side.outline[0] ?? [0, 0, 0])).toBeGreaterThan(0);
    }
  });

  it('have the whole model on one side, and touch it', () => {
    const points = Array.from({ length: 300 }, (_, i) => (Math.sin(12.9898 * (i + 1)) * 43758.5453) % 1);
    const sides = findFlatSides(points);
    expect(sides.length).toBeGreaterThan(5);
    for (const { normal, support } of sides) {
      const [on = [0, 0, 0]] = support;
      for (const point of support) expect(Math.abs(dot(normal, minus(point, on)))).toBeLessThan(1e-9);
      for (let i = 0; i < points.length; i += 3) {
        const point = points.slice(i, i + 3) as unknown as Vec3;
        expect(dot(normal, minus(point, on))).toBeLessThan(1e-9);
      }
    }
  });

  it('join triangles that lean by less than a degree', () => {
    // The lid of a box, raised in the middle by 0.004 of its half width: 0.23 degrees.
    const lid = [0, 1.004, 0, ...[-1, 1].flatMap((x) => [-1, 1].flatMap((z) => [x, 1, z, x, -1, z]))];
    expect(findFlatSides(lid)).toHaveLength(6);
    const roof = lid.map((value, i) => (i === 1 ? 1.1 : value));
    expect(findFlatSides(roof)).toHaveLength(9);
  });

  it('are none of what is round all over, and of nothing', () => {
    expect(findFlatSides(spherePoints(1500))).toEqual([]);
    expect(findFlatSides([])).toEqual([]);
    expect(findFlatSides([0, 0, 0, 1, 0, 0])).toEqual([]);
  });
});
