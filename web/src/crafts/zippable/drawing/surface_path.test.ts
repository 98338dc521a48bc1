// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { SurfaceGraph } from './surface_path';

/** A square of n × n cells from −1 to 1, each cut along one diagonal. */
function sheet(n: number, height: (x: number, y: number) => number) {
  const positions: number[] = [];
  const indices: number[] = [];
  for (let j = 0; j <= n; ++j)
    for (let i = 0; i <= n; ++i) {
      const [x, y] = [(2 * i) / n - 1, (2 * j) / n - 1];
      positions.push(x, y, height(x, y));
      if (i === n || j === n) continue;
      const v = j * (n + 1) + i;
      indices.push(v, v + 1, v + n + 2, v, v + n + 2, v + n + 1);
    }
  return new SurfaceGraph(Float32Array.from(positions), indices);
}

const lengthOf = (line: ArrayLike<number>) => {
  let sum = 0;
  for (let i = 3; i < line.length; i += 3)
    sum += Math.hypot(...[0, 1, 2].map((k) => (line[i + k] ?? 0) - (line[i + k - 3] ?? 0)));
  return sum;
};

describe('the way between two points of a border', () => {
  it('is straight where edges are, and begins and ends exactly', () => {
    const line = sheet(20, () => 0).path([-0.91, 0.02, 0], [0.93, -0.01, 0]);
    expect(line.slice(0, 3)).toEqual([-0.91, 0.02, 0]);
    expect(line.slice(-3)).toEqual([0.93, -0.01, 0]);
    expect(lengthOf(line)).toBeLessThan(1.02 * 1.84);
  });

  it('goes around a hill that is longer to climb', () => {
    const graph = sheet(60, (x, y) => 3 * Math.exp(-12 * (x * x + y * y)));
    const line = graph.path([-0.8, 0, 0], [0.8, 0, 0]);
    const highest = Math.max(...line.filter((_, i) => i % 3 === 2));
    expect(highest).toBeLessThan(1);
    // Along the edges of a grid no way is longer than 1.09 times the straight one.
    expect(lengthOf(line)).toBeLessThan(2.4);
  });

  it('comes back to the first point where it is closed', () => {
    const graph = sheet(20, () => 0);
    const corners = [
      [-0.5, -0.5, 0],
      [0.5, -0.5, 0],
      [0.5, 0.5, 0],
    ] as const;
    const line = graph.through(corners, true);
    expect([...line.slice(-3)]).toEqual([-0.5, -0.5, 0]);
    expect(lengthOf(line)).toBeGreaterThan(lengthOf(graph.through(corners, false)) + 1.3);
    expect(graph.through(corners.slice(0, 1), false)).toHaveLength(0);
  });

  it('is not sought again between points that stay', () => {
    const graph = sheet(20, () => 0);
    const [p, q] = [[-0.5, -0.5, 0] as const, [0.5, -0.5, 0] as const];
    expect(graph.path(p, q)).toBe(graph.path(p, q));
    expect(graph.path(p, [...q])).toEqual(graph.path(p, q));
  });
});
