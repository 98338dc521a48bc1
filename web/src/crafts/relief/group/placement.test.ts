// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { PlacedModel } from '../../../shared/session/craft_document';
import type { Vector } from '../../../shared/geometry/rotation';
import { anglesOf, movedVertices, placeBeside, reach, rotationOf, turnedBy, viewAxes } from './placement';

const source = { kind: 'sample', sample: 'cat', title: 'Cat' } as const;
const placed = (size_mm: number, turn_deg: Vector, at_mm: Vector): PlacedModel => ({
  source,
  name: 'Cat',
  size_mm,
  turn_deg,
  at_mm,
});
/** 1 x 2 x 4 about the origin. */
const brick = Float32Array.from(
  [0, 1, 2, 3, 4, 5, 6, 7].flatMap((i) => [i & 1 ? 0.5 : -0.5, i & 2 ? 1 : -1, i & 4 ? 2 : -2]),
);
const boxOf = (positions: Float32Array) =>
  [0, 1, 2].map((k) => {
    const values = positions.filter((_, i) => i % 3 === k);
    return [Math.min(...values), Math.max(...values)];
  });
const close = (a: readonly number[], b: readonly number[], digits = 4) =>
  a.forEach((value, i) => expect(value).toBeCloseTo(b[i] ?? NaN, digits));

describe('placement of models', () => {
  it('turns about x first, then y, then z', () => {
    // (x, y, z) -> about x (x, -z, y) -> about y (y, -z, -x)
    close(rotationOf([90, 90, 0]), [0, 1, 0, 0, 0, -1, -1, 0, 0]);
  });

  it('finds angles for every rotation', () => {
    for (const turn of [
      [10, 20, 30],
      [-170, 80, 5],
      [0, 90, 0],
      [35, -90, 0],
      [179, -45, -179],
    ] as const) {
      const rotation = rotationOf(turn);
      close(rotationOf(anglesOf(rotation)), rotation, 5);
    }
    close(turnedBy([0, 0, 0], [0, 1, 0], 25), [0, 25, 0]);
  });

  it('moves vertices as the core places them', () => {
    const before = placed(4, [0, 0, 0], [0, 0, 0]);
    const after = movedVertices(brick, before, placed(100, [0, 0, 90], [5, -3, 2]));
    close(boxOf(after).flat(), [-20, 30, -15.5, 9.5, -48, 52], 3);
    // And back, over any turn.
    const skew = placed(60, [17, -50, 71], [40, 5, -9]);
    const there = movedVertices(brick, before, skew);
    close([...movedVertices(there, skew, before)], [...brick], 4);
  });

  it('puts a new model beside the others on the same ground', () => {
    const axes = viewAxes([0, 0, -1], [0, 1, 0]);
    close(axes.right, [1, 0, 0]);
    close(axes.up, [0, 1, 0]);
    const boxes = [
      { at_mm: [0, 50, 0], size_mm: [40, 100, 20] },
      { at_mm: [60, 30, 30], size_mm: [20, 60, 20] },
    ] as const;
    expect(reach(boxes, axes.right)).toEqual({ low: -20, high: 70 });
    expect(placeBeside(boxes, [30, 80, 10], axes)).toEqual([95, 40, 15]);
    // Seen from the right of the models, their right is towards -z.
    const side = viewAxes([-1, 0, 0], [0, 1, 0]);
    close(side.right, [0, 0, -1]);
    expect(placeBeside(boxes, [30, 80, 10], side)).toEqual([25, 40, -25]);
  });
});
