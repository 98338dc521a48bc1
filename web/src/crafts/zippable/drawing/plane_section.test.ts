// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { Place3 } from './drawn_parts';
import type { Chain } from './plane_section';
import { planeSection } from './plane_section';
import { ball, lengthOf, planeAcross, roll } from './section_models';

describe('where a plane meets a mesh', () => {
  it('is a circle on a ball, and as long', () => {
    for (const normal of [
      [0, 1, 0],
      [1, 0.3, -0.2],
      [0.1, 0.7, 0.3],
    ] as const) {
      const chains = planeSection(...ball(48), planeAcross(normal));
      expect(chains.map(({ closed }) => closed)).toEqual([true]);
      const length = lengthOf(chains[0] as Chain);
      // Chords of arcs of at most 180/48 degrees are shorter by at most 0.1 %, their mesh lies inside by as much.
      expect(length).toBeLessThan(2 * Math.PI);
      expect(length).toBeGreaterThan(2 * Math.PI * 0.997);
    }
  });

  it('goes through vertices that lie exactly on the plane', () => {
    // Row 24 of 48 is the equator; the planes x = 0 and z = 0 hold whole meridians and both poles.
    for (const normal of [
      [0, 1, 0],
      [1, 0, 0],
      [0, 0, 1],
    ] as const)
      for (const side of [1, -1]) {
        const turned = normal.map((x) => side * x) as unknown as Place3;
        const chains = planeSection(...roundedBall(), planeAcross(turned));
        expect(chains).toHaveLength(1);
        expect(chains[0]?.closed).toBe(true);
        expect(lengthOf(chains[0] as Chain)).toBeGreaterThan(2 * Math.PI * 0.997);
      }
  });

  it('is nothing beside the mesh', () => {
    expect(planeSection(...ball(12), planeAcross([0, 1, 0], 1.5))).toEqual([]);
  });

  it('is an open chain on an open surface', () => {
    const open = planeSection(...roll(), planeAcross([0, 1, 0], 0.013));
    expect(open.map(({ closed }) => closed)).toEqual([false]);
    // Half a circle from rim to rim.
    expect(lengthOf(open[0] as Chain)).toBeCloseTo(Math.PI, 1);
    expect(open[0]?.points[1]).toBeCloseTo(0.013, 6);
  });

  it('counts the vertices that a loop goes around', () => {
    const nearPole = planeSection(...ball(12), planeAcross([0, 1, 0], 0.999));
    expect(nearPole[0]?.verticesBeside).toBe(1);
    expect(planeSection(...ball(12), planeAcross([0, 1, 0], 0.01))[0]?.verticesBeside).toBe(24);
  });
});

/** Whose coordinates on the three planes are 0 and not a rounding's rest. */
function roundedBall(): [Float32Array, number[]] {
  const [positions, indices] = ball(48);
  return [positions.map((x) => (Math.abs(x) < 1e-6 ? 0 : x)), indices];
}
