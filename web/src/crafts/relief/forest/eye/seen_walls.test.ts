// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { Plan } from '../plan';
import type { Place, Scene, Viewpoint } from '../scene';
import { EyeCamera } from './eye_camera';
import { seenPillars } from './seen_walls';

const viewpoint: Viewpoint = { eye_mm: [0, -100, 50], look_at_mm: [0, 0, 50], width_mm: 40 };
const square = (x: number, y: number, half: number): Place[] => [
  [x - half, y - half],
  [x + half, y - half],
  [x + half, y + half],
  [x - half, y + half],
];
const planOf = (pillars_mm: Place[][], more: Partial<Plan> = {}): Plan => ({
  viewpoints: [],
  shared: [],
  pillars_mm,
  ...more,
});
const sceneOf = (count: number): Scene => ({
  viewpoints: [viewpoint],
  pillars: Array.from({ length: count }, () => ({
    shape: 'square' as const,
    x_mm: 0,
    y_mm: 0,
    width_mm: 10,
    height_mm: 80,
  })),
});
const order = (pillars_mm: Place[][]) =>
  seenPillars(new EyeCamera(viewpoint), planOf(pillars_mm), sceneOf(pillars_mm.length)).map(
    ({ pillar }) => pillar,
  );

describe('an eye', () => {
  it('sees places where straight lines from it meet the plane through what it looks at', () => {
    const camera = new EyeCamera(viewpoint);
    expect(camera.seen([10, 0], 70)).toEqual({ x_mm: 10, y_mm: 20 });
    // Half-way to the eye everything is twice as large.
    expect(camera.seen([10, -50], 70)).toEqual({ x_mm: 20, y_mm: 40 });
  });

  it('sees upright edges that lean when it looks down', () => {
    const camera = new EyeCamera({ ...viewpoint, eye_mm: [0, -100, 150] });
    const [foot, head] = [camera.seen([30, 0], 0), camera.seen([30, 0], 100)];
    expect(head.x_mm).toBeGreaterThan(foot.x_mm);
    expect(head.y_mm).toBeGreaterThan(foot.y_mm);
  });
});

describe('pillars as an eye sees them', () => {
  it('come before those that stand in front of them', () => {
    expect(order([square(0, 0, 5), square(3, -40, 5), square(-2, 40, 5)])).toEqual([2, 0, 1]);
    expect(order([square(3, -40, 5), square(-2, 40, 5), square(0, 0, 5)])).toEqual([1, 2, 0]);
  });

  it('are ordered by what hides what, not by how near they are', () => {
    // A long wall whose far end is farther away than the pillar that it hides, which its near end does.
    const wall: Place[] = [
      [-6, -30],
      [60, 60],
      [58, 62],
      [-8, -28],
    ];
    expect(order([wall, square(-6, -5, 3)])).toEqual([1, 0]);
  });

  it('leave out what stands behind the eye, and walls that are turned away', () => {
    const seen = seenPillars(
      new EyeCamera(viewpoint),
      planOf([square(0, 0, 5), square(0, -130, 5)]),
      sceneOf(2),
    );
    expect(seen).toHaveLength(1);
    expect(seen[0]?.walls.map(({ foot_mm }) => foot_mm)).toEqual([
      [
        [-5, -5],
        [5, -5],
      ],
    ]);
  });

  it('have the strips of every viewpoint on the wall where these lie', () => {
    const strip: Place[] = [
      [-4, -5],
      [2, -5],
    ];
    const hidden: Place[] = [
      [5, 3],
      [5, -3],
    ];
    const eye_mm: Place = [0, -100];
    const plan = planOf([square(0, 0, 5)], {
      viewpoints: [
        { eye_mm, sight_mm: [], surfaces: [{ pillar: 1, line_mm: strip }] },
        { eye_mm, sight_mm: [], surfaces: [{ pillar: 1, line_mm: hidden }] },
      ],
      shared: [
        {
          pillar: 1,
          viewpoints: [1, 2],
          line_mm: [
            [2, -5],
            [4, -5],
          ],
        },
      ],
    });
    const [pillar] = seenPillars(new EyeCamera(viewpoint), plan, sceneOf(1));
    expect(pillar?.walls.flatMap(({ strips }) => strips.map(({ owners }) => owners))).toEqual([[0], [0, 1]]);
  });
});
