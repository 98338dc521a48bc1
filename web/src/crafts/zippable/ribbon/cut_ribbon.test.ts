// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { woundDesign } from './test_ribbon';
import { cutByParts, withCutPoints } from './cut_ribbon';
import { PartBorders } from './part_borders';
import { partsOfTriangles, VertexGrid } from './part_map';

const [radius_mm, height_mm, columns, rows] = [30, 60, 72, 40] as const;
/** The parts meet at this height. */
const level_mm = 21;

/** A cylinder of two parts, the upper one above `level_mm`; vertices are apart at the border. */
function dividedCylinder() {
  const [positions, segment, indices] = [[] as number[], [] as number[], [] as number[]];
  const levels = (from: number, to: number) =>
    Array.from({ length: rows + 1 }, (_, i) => from + ((to - from) * i) / rows);
  [levels(-10, level_mm), levels(level_mm, height_mm)].forEach((heights, part) => {
    const first = segment.length;
    for (const z of heights)
      for (let j = 0; j < columns; ++j) {
        const angle = (2 * Math.PI * j) / columns;
        positions.push(radius_mm * Math.cos(angle), radius_mm * Math.sin(angle), z);
        segment.push(part);
      }
    for (let i = 0; i < rows; ++i)
      for (let j = 0; j < columns; ++j) {
        const at = (row: number, column: number) => first + row * columns + (column % columns);
        indices.push(at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i + 1, j));
      }
  });
  return {
    positions: Float32Array.from(positions),
    indices: Uint32Array.from(indices),
    attributes: { segment: Float32Array.from(segment) },
  };
}

const cutStrip = () => {
  const { ribbon } = woundDesign(24);
  const mesh = dividedCylinder();
  const grid = new VertexGrid(mesh.positions);
  const middles = partsOfTriangles(ribbon, mesh.attributes.segment, grid);
  return { ribbon, pieces: cutByParts(ribbon, middles, new PartBorders(mesh, grid)) };
};

function areaOf(positions: Float32Array, triangles: Uint32Array): number {
  let area = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    const [a = 0, b = 0, c = 0] = triangles.subarray(t, t + 3);
    const side = (to: number) =>
      [0, 1, 2].map((k) => (positions[3 * to + k] ?? 0) - (positions[3 * a + k] ?? 0));
    const [p = [], q = []] = [side(b), side(c)];
    const cross = [0, 1, 2].map(
      (k) => (p[(k + 1) % 3] ?? 0) * (q[(k + 2) % 3] ?? 0) - (p[(k + 2) % 3] ?? 0) * (q[(k + 1) % 3] ?? 0),
    );
    area += Math.hypot(...cross) / 2;
  }
  return area;
}

describe('a ribbon over two parts', () => {
  it('is cut where the parts meet, not from corner to corner', () => {
    const { ribbon, pieces } = cutStrip();
    const positions = withCutPoints(ribbon.positions, 3, pieces);
    expect(pieces.corners.length).toBeGreaterThan(0);
    for (let at = ribbon.positions.length + 2; at < positions.length; at += 3)
      expect(Math.abs((positions[at] ?? 0) - level_mm)).toBeLessThan(0.3);
    pieces.triangles.forEach((vertex, i) => {
      const over = (positions[3 * vertex + 2] ?? 0) - level_mm;
      expect(pieces.part[Math.floor(i / 3)] === 1 ? over : -over).toBeGreaterThan(-0.3);
    });
  });

  it('keeps its area, and every piece lies in its triangle', () => {
    const { ribbon, pieces } = cutStrip();
    const positions = withCutPoints(ribbon.positions, 3, pieces);
    expect(areaOf(positions, pieces.triangles)).toBeCloseTo(areaOf(ribbon.positions, ribbon.triangles), 2);
    for (let i = 0; i < pieces.weights.length; i += 3) {
      const weights = [...pieces.weights.subarray(i, i + 3)];
      expect(weights.reduce((sum, weight) => sum + weight)).toBeCloseTo(1, 5);
      expect(Math.min(...weights)).toBeGreaterThanOrEqual(0);
    }
    expect(Math.max(...pieces.of)).toBe(ribbon.triangles.length / 3 - 1);
  });

  it('shares the points on an edge between its two triangles', () => {
    const { ribbon, pieces } = cutStrip();
    const uses = new Map<number, Set<number>>();
    pieces.triangles.forEach((vertex, i) => {
      if (vertex < ribbon.sample.length) return;
      const of = uses.get(vertex) ?? new Set();
      uses.set(vertex, of.add(pieces.of[Math.floor(i / 3)] ?? -1));
    });
    expect([...uses.values()].filter((of) => of.size === 2).length).toBeGreaterThan(0);
  });
});

it('a place is deeper in its part by twice the distance from the border', () => {
  const mesh = dividedCylinder();
  const borders = new PartBorders(mesh, new VertexGrid(mesh.positions));
  for (const z of [5, 18.5, 20.2, 24, 40]) {
    // Half way between two columns of vertices.
    const angle = Math.PI / columns;
    const chord = radius_mm * Math.cos(Math.PI / columns);
    const point = [chord * Math.cos(angle), chord * Math.sin(angle), z] as const;
    const inside = borders.partAt(point);
    expect(inside).toBe(z > level_mm ? 1 : 0);
    expect(borders.deeper(point, inside, 1 - inside, inside)).toBeCloseTo(2 * Math.abs(z - level_mm), 4);
    expect(borders.deeper(point, 1 - inside, inside, inside)).toBeCloseTo(-2 * Math.abs(z - level_mm), 4);
  }
});
