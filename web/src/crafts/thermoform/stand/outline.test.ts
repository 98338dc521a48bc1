// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { Pixel } from './outline';
import { distanceTo, signedArea } from './outline';

/** A square from 10 to 20 px; clockwise to the eye, since y points down. */
const square: Pixel[] = [
  [10, 10],
  [20, 10],
  [20, 20],
  [10, 20],
];

describe('an outline in the picture', () => {
  it('tells a face seen from outside from one seen from inside', () => {
    expect(signedArea(square)).toBe(200);
    expect(signedArea([...square].reverse())).toBe(-200);
    expect(signedArea([])).toBe(0);
  });

  it('knows how far a point is from it, and what is inside', () => {
    expect(distanceTo(square, [15, 12])).toBe(0);
    expect(distanceTo(square, [15, 24])).toBeCloseTo(4, 9);
    expect(distanceTo(square, [23, 24])).toBeCloseTo(5, 9);
    expect(distanceTo([], [0, 0])).toBe(Infinity);
  });
});
