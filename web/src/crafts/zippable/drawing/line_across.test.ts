// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { Sight } from './line_across';
import { chainAcross, planeThrough } from './line_across';
import type { Plane } from './plane_section';
import { distanceTo, planeSection } from './plane_section';
import { ringAcross } from './ring_across';
import { spread } from './ring_points';
import { ball, both, moved, roll } from './section_models';
import { SurfaceGraph } from './surface_path';

/** From z = 10, in the plane y = 0 or tilted with it. */
function sightsFromEye(from_x: number, to_x: number, rise = 0): Sight[] {
  return Array.from({ length: 41 }, (_, i) => {
    const x = from_x + (i / 40) * (to_x - from_x);
    const length = Math.hypot(x, rise * x, 10);
    return { origin: [0, 0, 10], direction: [x / length, (rise * x) / length, -10 / length] };
  });
}

describe('the loop that a line across means', () => {
  const limbs = () => both(moved(ball(24), [-1.5, 0, 0]), moved(ball(24), [1.5, 0, 0]));

  it('is the one under the line, though the plane cuts both', () => {
    for (const [from, to, side] of [
      [-3, -0.2, -1],
      [0.2, 3, 1],
    ] as const) {
      const sights = sightsFromEye(from, to);
      const cut = planeThrough(sights[0] as Sight, sights.at(-1) as Sight) as Plane;
      const chains = planeSection(...limbs(), cut);
      expect(chains).toHaveLength(2);
      const seen = chainAcross(chains, cut, sights);
      expect(Math.sign(seen?.chain.points[0] ?? 0)).toBe(side);
    }
  });

  it('is the nearer one where two lie behind each other, seen at its front', () => {
    const behind = both(moved(ball(24), [0, 0, -3]), ball(24));
    const sights = sightsFromEye(-2, 2, 0.3);
    const cut = planeThrough(sights[0] as Sight, sights.at(-1) as Sight) as Plane;
    const seen = chainAcross(planeSection(...behind, cut), cut, sights);
    const [front] = spread(seen as NonNullable<typeof seen>, 6);
    expect(front?.[2]).toBeGreaterThan(0.98);
    expect(Math.abs(front?.[0] ?? 1)).toBeLessThan(0.2);
  });

  it('is the same from an eye at no distance, by parallel lines of sight', () => {
    const sights = [-1.2, -0.4, 0.4, 1.2].map((x): Sight => ({
      origin: [x, 0.25 * x + 0.1, 10],
      direction: [0, 0, -1],
    }));
    const cut = planeThrough(sights[0] as Sight, sights.at(-1) as Sight) as Plane;
    for (const { origin, direction } of sights) {
      expect(distanceTo(cut, origin)).toBeCloseTo(0, 12);
      expect(cut.normal[2] * direction[2]).toBeCloseTo(0, 12);
    }
    expect(chainAcross(planeSection(...ball(24), cut), cut, sights)?.chain.closed).toBe(true);
  });

  it('is none where the line passes the mesh', () => {
    const sights = sightsFromEye(5, 8);
    const cut = planeThrough(sights[0] as Sight, sights.at(-1) as Sight) as Plane;
    expect(chainAcross(planeSection(...ball(24), cut), cut, sights)).toBeNull();
    expect(planeThrough(sights[0] as Sight, sights[0] as Sight)).toBeNull();
  });
});

describe('a border by one line', () => {
  const border = (model: ReturnType<typeof ball>, sights: readonly Sight[]) =>
    ringAcross({ positions: model[0], indices: model[1] }, sights, () => new SurfaceGraph(...model));

  it('goes all around', () => {
    const points = border(ball(24), sightsFromEye(-2, 2, 0.1));
    if (typeof points === 'string') throw new Error(points);
    expect(points.length).toBeGreaterThanOrEqual(3);
    const angles = points.map(([x, , z]) => Math.atan2(x, z)).sort((a, b) => a - b);
    const gaps = angles.map((angle, i) => (angles[i + 1] ?? (angles[0] ?? 0) + 2 * Math.PI) - angle);
    expect(Math.max(...gaps)).toBeLessThan(2);
  });

  it('says why there is none: beside the model, on an open edge, around a single vertex', () => {
    expect(border(ball(24), sightsFromEye(5, 8))).toContain('does not cross');
    expect(border(roll(), sightsFromEye(-2, 2, 0.1))).toContain('open edge');
    const aroundPole: Sight[] = [-0.3, 0, 0.3].map((x) => ({
      origin: [x, 0.999, 10],
      direction: [0, 0, -1],
    }));
    expect(border(ball(24), aroundPole)).toContain('too few triangles');
  });
});
