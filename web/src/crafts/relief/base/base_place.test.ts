// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { BasePlace, PlateAxes } from './base_place';
import { angleBetween, byKey, onPlane, originOf, turnedBy } from './base_place';

/** A viewer who looks along y, upright. */
const axes: PlateAxes = { middleMm: [10, 20, 30], right: [1, 0, 0], up: [0, 0, 1], towards: [0, -1, 0] };
const place: BasePlace = { x_mm: 3, y_mm: 4, z_mm: 5, turn_deg: 170 };

describe('a base from a file', () => {
  it('has its origin right of, above and before the middle of the plate', () => {
    expect(originOf(place, axes)).toEqual([13, 15, 34]);
  });

  it('is moved in the plane where it is held', () => {
    const ray = { originMm: [13, -100, 34] as const, direction: [0, 1, 0] as const };
    expect(onPlane(ray, axes, 5)).toEqual([3, 4]);
    // Half as far ahead a slanting ray has gone half as far aside.
    const slanting = { originMm: [10, -80, 30] as const, direction: [0.1, 1, 0] as const };
    expect(onPlane(slanting, axes, 0)?.[0]).toBeCloseTo(10, 12);
    expect(onPlane(slanting, axes, 50)?.[0]).toBeCloseTo(5, 12);
    expect(onPlane({ ...ray, direction: [1, 0, 0] }, axes, 5)).toBeNull();
    expect(onPlane({ ...ray, direction: [0, -1, 0] }, axes, 5)).toBeNull();
  });

  it('turns with the pointer, past half a turn too', () => {
    expect(angleBetween([0, 0], [10, 0], [0, -10])).toBeCloseTo(90, 12);
    expect(angleBetween([0, 0], [-10, -1], [-10, 1])).toBeCloseTo(11.42, 2);
    expect(turnedBy(place, 22, false).turn_deg).toBe(-170);
    expect(turnedBy(place, 22, true).turn_deg).toBe(-168);
  });

  it('follows the arrow keys', () => {
    expect(byKey(place, 'move', 'ArrowLeft', false)).toMatchObject({ x_mm: -2, y_mm: 4 });
    expect(byKey(place, 'move', 'ArrowUp', true)).toMatchObject({ x_mm: 3, y_mm: 5 });
    expect(byKey(place, 'depth', 'ArrowUp', false)).toMatchObject({ z_mm: 0 });
    expect(byKey({ ...place, turn_deg: 0 }, 'turn', 'ArrowLeft', false)).toMatchObject({ turn_deg: 15 });
    expect(byKey({ ...place, turn_deg: 0 }, 'turn', 'ArrowRight', true)).toMatchObject({ turn_deg: -1 });
    expect(byKey(place, 'move', 'Enter', false)).toBeNull();
  });
});
