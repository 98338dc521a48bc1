// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { boxOf, carriedOn, clearance_mm, onLevel, placed, placementOf, rotationOf } from './placement';

/** A box of 4 x 2 x 1 about the origin, y up, and where the core puts it: z up on the plate, not scaled. */
const box = Float32Array.from(
  [-2, 2].flatMap((x) => [-1, 1].flatMap((y) => [-0.5, 0.5].flatMap((z) => [x, y, z]))),
);
const standing = [1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 1, 0, 0, 0, 1];
const parameters = { up: [0, 1, 0], size_mm: 4, turn_deg: 0, x_mm: 0, y_mm: 0, sink_mm: 0 };

const close = (actual: readonly number[] | null, expected: readonly number[]) => {
  expect(actual).not.toBeNull();
  actual?.forEach((value, i) => expect(value).toBeCloseTo(expected[i] ?? NaN, 9));
};

describe('where the model stands', () => {
  it('is read from a report, or not at all', () => {
    expect(placementOf({ placement: standing })).toEqual(standing);
    expect(placementOf({ placement: standing.slice(1) })).toBeNull();
    expect(placementOf({})).toBeNull();
  });

  it('puts the model on the plate', () => {
    expect(boxOf(placed(box, standing))).toEqual({ low: [-2, -0.5, 0], high: [2, 0.5, 2] });
  });

  it('follows shifts and sinking to the letter', () => {
    const moved = carriedOn(standing, parameters, { ...parameters, x_mm: 7, y_mm: -3, sink_mm: 0.5 }, box);
    close(moved, [1, 0, 0, 7, 0, 0, -1, -3, 0, 1, 0, 0.5, 0, 0, 0, 1]);
  });

  it('turns about the vertical axis, counter-clockwise from above, and stays in its place', () => {
    const from = { ...parameters, x_mm: 10 };
    const there = carriedOn(standing, parameters, from, box) ?? [];
    const turned = carriedOn(there, from, { ...from, turn_deg: 90 }, box) ?? [];
    const { low, high } = boxOf(placed(box, turned));
    close([...low, ...high], [9.5, -2, 0, 10.5, 2, 2]);
    const [x, y] = placed([2, 0, 0], turned);
    expect(x).toBeCloseTo(10);
    expect(y).toBeCloseTo(2);
    close(rotationOf(turned), [0, 0, 1, 1, 0, 0, 0, 1, 0]);
  });

  it('grows from the plate; turning and back changes nothing', () => {
    const larger = carriedOn(standing, parameters, { ...parameters, size_mm: 8 }, box) ?? [];
    const { low, high } = boxOf(placed(box, larger));
    close([...low, ...high], [-4, -1, 0, 4, 1, 4]);
    const turn = { ...parameters, turn_deg: 33, size_mm: 9 };
    const there = carriedOn(standing, parameters, turn, box) ?? [];
    close(carriedOn(there, turn, parameters, box), standing);
  });

  it('is put another way up, and by the automatic size', () => {
    const lying = carriedOn(standing, parameters, { ...parameters, up: [0, 0, 1] }, box) ?? [];
    const { low, high } = boxOf(placed(box, lying));
    close([...low, ...high], [-2, -1, 0, 2, 1, 1]);
    const opening = { clamp_opening_x_mm: 200, clamp_opening_y_mm: 150 };
    const sized = carriedOn(
      standing,
      { ...parameters, ...opening },
      { ...parameters, ...opening, size_mm: null },
      box,
    );
    const large = boxOf(placed(box, sized ?? []));
    close([...large.low, ...large.high], [-50, -12.5, 0, 50, 12.5, 50]);
  });

  it('stays displaced as the core has displaced it', () => {
    // Turned by 2 degrees, 1 % larger, and 3 mm to the right: as a machine profile says.
    const [c, s] = [1.01 * Math.cos(Math.PI / 90), 1.01 * Math.sin(Math.PI / 90)];
    const displaced = [c, 0, s, 3, s, 0, -c, 0, 0, 1.01, 0, 1.01, 0, 0, 0, 1];
    close(carriedOn(displaced, parameters, { ...parameters, up: [0, 0, 1] }, box), [
      ...[c, -s, 0, 3],
      ...[s, c, 0, 0],
      ...[0, 0, 1.01, 0.505],
      ...[0, 0, 0, 1],
    ]);
  });

  it('leaves to the core what it refuses', () => {
    expect(carriedOn(standing, parameters, { ...parameters, up: [0, 0, 0] }, box)).toBeNull();
  });

  it('says how far it is from the clamp, and how far it reaches beyond', () => {
    const at = (x: number) => ({ low: [x - 2, -1, 0] as const, high: [x + 2, 1, 3] as const });
    expect(clearance_mm(at(0), [20, 20])).toBe(8);
    expect(clearance_mm(at(0), [20, 6])).toBe(2);
    expect(clearance_mm(at(9), [20, 20])).toBe(-1);
    expect(clearance_mm(at(-11), [20, 20])).toBe(-3);
  });

  it('finds the platform under the pointer', () => {
    const ray = { originMm: [0, -10, 10] as const, direction: [0, 1, -1] as const };
    expect(onLevel(ray, 0)).toEqual([0, 0]);
    expect(onLevel(ray, 20)).toBeNull();
    expect(onLevel({ ...ray, direction: [1, 0, 0] }, 0)).toBeNull();
  });
});
