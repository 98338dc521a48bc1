// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { Place3 } from './drawn_parts';
import type { Chain } from './plane_section';
import { distanceTo, planeSection } from './plane_section';
import { farthestFrom, ringPoints, spread } from './ring_points';
import { ball, lengthOf, planeAcross, tube } from './section_models';
import { SurfaceGraph } from './surface_path';

describe('the points of a border along a loop', () => {
  const models = {
    ball: ball(48),
    tube: tube(96, 48, () => 1),
    // A limb as thin as a third of the body, and corners that the way could cut.
    waist: tube(96, 48, (y) => 1 - 0.65 * Math.exp(-8 * y * y)),
    square: tube(96, 48, () => 1, 12),
  };
  const cuts: readonly Place3[] = [
    [0, 1, 0],
    [0.2, 1, 0.1],
    [0.5, 1, -0.3],
  ];

  it.each(Object.keys(models) as (keyof typeof models)[])('keep the way near the plane: %s', (name) => {
    const [positions, indices] = models[name];
    const graph = new SurfaceGraph(positions, indices);
    for (const normal of cuts) {
      const cut = planeAcross(normal, 0.037);
      const [chain] = planeSection(positions, indices, cut);
      const seen = { chain: chain as Chain, at: 3.25 };
      const points = ringPoints(seen, cut, graph);
      expect(points.length).toBeGreaterThanOrEqual(3);
      expect(points.length).toBeLessThanOrEqual(24);
      for (const point of points) expect(distanceTo(cut, point)).toBeCloseTo(0, 6);
      const away = farthestFrom(cut, points, graph);
      const long = lengthOf(seen.chain);
      expect(away).toBeLessThan(Math.max(seen.chain.edgeLength, 0.01 * long));
      const way = graph.through(points, true);
      const shown = lengthOf({ ...seen.chain, points: Float64Array.from(way), closed: true });
      expect(shown / long).toBeGreaterThan(0.9);
      expect(shown / long).toBeLessThan(1.1);
    }
  });

  it('are closer where the loop bends', () => {
    const [positions, indices] = models.square;
    const cut = planeAcross([0, 1, 0], 0.037);
    const [chain] = planeSection(positions, indices, cut);
    const points = spread({ chain: chain as Chain, at: 0 }, 16);
    expect(points).toHaveLength(16);
    const nearCorner = points.filter(([x, , z]) => Math.min(Math.abs(x), Math.abs(z)) > 0.75);
    expect(nearCorner.length).toBeGreaterThanOrEqual(8);
  });
});
