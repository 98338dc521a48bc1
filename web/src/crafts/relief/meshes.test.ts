// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { Viewpoint } from '../../view';
import { parametersOf } from './meshes';

const degrees = (half: number, distance: number) => (2 * Math.atan(half / distance) * 180) / Math.PI;

/** Corners of a box about the origin, model units. */
function box(width: number, height: number, depth: number): Float32Array {
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((k) => [
    (k & 1 ? 0.5 : -0.5) * width,
    (k & 2 ? 0.5 : -0.5) * height,
    (k & 4 ? 0.5 : -0.5) * depth,
  ]);
  return Float32Array.from(corners);
}

const before = (distanceMm: number, rest: Partial<Viewpoint> = {}): Viewpoint => ({
  projection: 'perspective',
  direction: [0, 0, -1],
  up: [0, 1, 0],
  targetMm: [0, 0, 0],
  distanceMm,
  fieldOfViewDeg: 20,
  ...rest,
});

describe('a camera as parameters of the relief', () => {
  it('says the angle of the model’s width, whatever window it is seen through', () => {
    const flat = box(100, 60, 0);
    const angle = degrees(50, 300);
    for (const fieldOfViewDeg of [3, 20, 90])
      expect(parametersOf(before(300, { fieldOfViewDeg }), flat, 1)['field_of_view_deg']).toBeCloseTo(
        angle,
        2,
      );
  });

  it('measures on the plane through the middle of the depth', () => {
    // The front face, 20 mm nearer, is as wide there as 100 * 300 / 280.
    const angle = degrees((50 * 300) / 280, 300);
    expect(parametersOf(before(300), box(100, 60, 40), 1)['field_of_view_deg']).toBeCloseTo(angle, 2);
    const elsewhere = before(250, { targetMm: [0, 0, 50] });
    expect(parametersOf(elsewhere, box(100, 60, 40), 1)['field_of_view_deg']).toBeCloseTo(angle, 2);
  });

  it('puts an eye beside the model before it, and does not mind the scale', () => {
    const angle = degrees((50 * 300) / 280, 300);
    const beside = before(300, { targetMm: [35, -10, 0] });
    expect(parametersOf(beside, box(50, 30, 20), 2)['field_of_view_deg']).toBeCloseTo(angle, 2);
  });

  it('leaves an eye within the model to the operation, and a far one without an angle', () => {
    expect(parametersOf(before(10), box(100, 60, 40), 1)['field_of_view_deg']).toBe(120);
    const far = parametersOf(before(300, { projection: 'orthographic' }), box(1, 1, 1), 1);
    expect(far).toEqual({ direction: [0, 0, -1], up: [0, 1, 0], projection: 'orthographic' });
  });
});
