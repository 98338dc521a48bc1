// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { PlateAxes } from './base_place';
import { turnedBy } from './base_place';
import type { ShapePlace } from './shape_place';
import { draggedAcross, maxShift_mm, middleOf, shapeByKey } from './shape_place';

/** A viewer who looks along y, upright. */
const axes: PlateAxes = { middleMm: [10, 20, 30], right: [1, 0, 0], up: [0, 0, 1], towards: [0, -1, 0] };
const groove: ShapePlace = { shift_mm: 4, turn_deg: 0, movable: true, upwards: false };
const turned = { ...groove, turn_deg: 90 };
const stairs = { ...groove, upwards: true };

describe('a built-in base', () => {
  it('has its middle where it is shifted to', () => {
    expect(middleOf(groove, axes)).toEqual([14, 20, 30]);
    expect(middleOf(turned, axes)[2]).toBeCloseTo(34, 12);
    expect(middleOf(stairs, axes)[2]).toBeCloseTo(34, 12);
  });

  it('follows what of a drag goes across it', () => {
    expect(draggedAcross(groove, [3, 100]).shift_mm).toBeCloseTo(7, 12);
    expect(draggedAcross(turned, [100, -3]).shift_mm).toBeCloseTo(1, 12);
    expect(draggedAcross({ ...groove, turn_deg: 45 }, [1, 1]).shift_mm).toBeCloseTo(4 + Math.SQRT2, 12);
  });

  it('follows the arrow keys across it', () => {
    expect(shapeByKey(groove, 'move', 'ArrowLeft', false)?.shift_mm).toBe(-1);
    expect(shapeByKey(groove, 'move', 'ArrowUp', false)).toBeNull();
    expect(shapeByKey(turned, 'move', 'ArrowUp', true)?.shift_mm).toBe(5);
    expect(shapeByKey(stairs, 'move', 'ArrowDown', true)?.shift_mm).toBe(3);
    expect(shapeByKey({ ...groove, movable: false }, 'move', 'ArrowLeft', false)).toBeNull();
  });

  it('turns in steps, or freely', () => {
    expect(turnedBy(groove, 22, false)).toEqual({ ...groove, turn_deg: 20 });
    expect(turnedBy(groove, 22, true).turn_deg).toBe(22);
    expect(shapeByKey(groove, 'turn', 'ArrowLeft', false)?.turn_deg).toBe(15);
  });

  it('stays on its plate', () => {
    expect(maxShift_mm(groove, [100, 60], 5)).toBeCloseTo(49.5, 12);
    expect(maxShift_mm(turned, [100, 60], 5)).toBeCloseTo(29.7, 12);
    expect(maxShift_mm(stairs, [100, 60], 5)).toBeCloseTo(0.99 * 12, 12);
  });
});
