// SPDX-License-Identifier: GPL-3.0-or-later
import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import type { Rotation, Vector } from '../../../shared/geometry/rotation';
import type { Side } from './stance';
import { about, after, turned, unit } from '../../../shared/geometry/rotation';
import { laidOn, placedOn, rotationOf, sides, stanceOf } from './stance';

const close = (actual: readonly number[], expected: readonly number[], digits = 9) =>
  actual.forEach((value, i) => expect(value).toBeCloseTo(expected[i] ?? NaN, digits));
const asInFile = rotationOf({ up: [0, 1, 0], turn_deg: 0 }) as Rotation;

const number = fc.double({ min: -1, max: 1, noNaN: true });
const direction = fc
  .tuple(number, number, number)
  .filter((v) => Math.hypot(...v) > 0.1)
  .map((v) => unit(v) as Vector);
const rotation = fc
  .tuple(direction, fc.double({ min: -180, max: 180, noNaN: true }))
  .map(([axis, angle]) => about(axis, angle));

/** The sides of a model that stands as in its file, in the file's axes. */
const inFile: Record<Side, Vector> = {
  left: [-1, 0, 0],
  right: [1, 0, 0],
  front: [0, 0, 1],
  back: [0, 0, -1],
  top: [0, 1, 0],
};

describe('which way up a model stands', () => {
  it('is y up and z to the front, as most files are', () => {
    close(turned(asInFile, [0, 1, 0]), [0, 0, 1]);
    close(turned(asInFile, [0, 0, 1]), [0, -1, 0]);
    close(turned(asInFile, [1, 0, 0]), [1, 0, 0]);
    expect(rotationOf({ up: [0, 0, 0], turn_deg: 0 })).toBeNull();
  });

  it('is said by two parameters, whatever the rotation', () => {
    fc.assert(
      fc.property(rotation, (r) => {
        const stance = stanceOf(r);
        expect(Math.abs(stance.turn_deg)).toBeLessThanOrEqual(180);
        close(rotationOf(stance) ?? [], r, 3); // a hundredth of a degree is 0.00017
      }),
    );
    expect(stanceOf(asInFile)).toEqual({ up: [0, 1, 0], turn_deg: 0 });
  });

  it('puts a side on the plate by the smallest rotation', () => {
    fc.assert(
      fc.property(rotation, direction, (r, outward) => {
        const placed = placedOn(r, outward);
        close(turned(placed, outward), [0, 0, -1], 7);
        // A second time nothing is left to do.
        close(placedOn(placed, outward), placed, 7);
      }),
    );
  });

  it('keeps the front in front of a model that is put on its top', () => {
    const over = laidOn(asInFile, 'top');
    close(turned(over, [0, 1, 0]), [0, 0, -1]);
    close(turned(over, [0, 0, 1]), [0, -1, 0]);
  });

  it('lays the side down that is seen there, along one of the model’s own axes', () => {
    for (const side of Object.keys(sides) as Side[]) {
      const own = inFile[side];
      close(turned(laidOn(asInFile, side), own), [0, 0, -1]);
      // Turned by 30 degrees or leaning a little, the same side is meant and lies flat.
      close(turned(laidOn(after(about([0, 0, 1], 30), asInFile), side), own), [0, 0, -1]);
      close(turned(laidOn(after(about([0.6, 0.8, 0], 20), asInFile), side), own), [0, 0, -1]);
    }
  });

  it('four times on the same side is once around', () => {
    for (const side of ['left', 'right', 'front', 'back'] as const) {
      let r = after(about([0, 0, 1], 30), asInFile);
      for (let i = 0; i < 4; ++i) r = laidOn(r, side);
      expect(stanceOf(r).up).toEqual([0, 1, 0]);
    }
  });
});
