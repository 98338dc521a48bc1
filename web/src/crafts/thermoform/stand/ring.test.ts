// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { angleSeen, circle, handles, pointOn, ringAround, ticks } from './ring';
import { about, turned } from '../../../shared/geometry/rotation';

const box = { low: [-10, -40, 0], high: [50, 20, 90] } as const;

describe('the rings around a model', () => {
  it('enclose it, and turn as rotations about their axes do', () => {
    for (const handle of handles) {
      const ring = ringAround(box, handle);
      for (const angle of [0, 30, -75, 200]) {
        const fromCentre = (at: number) =>
          pointOn(ring, at).map((value, k) => value - (ring.centre[k] ?? 0)) as [number, number, number];
        const expected = turned(about(ring.axis, angle), fromCentre(0));
        fromCentre(angle).forEach((value, k) => expect(value).toBeCloseTo(expected[k] ?? NaN, 9));
      }
      expect(ring.radius_mm).toBeGreaterThan(Math.hypot(30, 30));
    }
    expect(ringAround({ low: [0, 0, 0], high: [1, 1, 1] }, 'turn').radius_mm).toBe(30);
  });

  it('know the angle under which they are seen', () => {
    const ring = ringAround(box, 'turn');
    const eye = [20, -400, 500] as const;
    for (const angle of [-170, -35, 0, 120]) {
      const point = pointOn(ring, angle);
      const direction = [point[0] - eye[0], point[1] - eye[1], point[2] - eye[2]] as const;
      expect(angleSeen(ring, { originMm: eye, direction })).toBeCloseTo(angle, 9);
    }
  });

  it('give no angle where they are seen from their edge', () => {
    const ring = ringAround(box, 'forwards');
    expect(angleSeen(ring, { originMm: [20, -400, 500], direction: [0.05, 1, -1] })).toBeNull();
  });

  it('are drawn as circles with a tick for each step', () => {
    const ring = ringAround(box, 'sideways');
    const points = circle(ring);
    for (let i = 0; i < points.length; i += 3) {
      const distance = Math.hypot(...[0, 1, 2].map((k) => (points[i + k] ?? 0) - (ring.centre[k] ?? 0)));
      expect(distance).toBeCloseTo(ring.radius_mm, 3);
    }
    expect(ticks(ring, 15)).toHaveLength((360 / 15) * 6);
  });
});
