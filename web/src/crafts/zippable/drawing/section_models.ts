// SPDX-License-Identifier: GPL-3.0-or-later
// Small meshes for the tests of cuts.
import type { Place3 } from './drawn_parts';
import type { Chain, Plane } from './plane_section';

type Model = [positions: Float32Array, indices: number[]];

/** Of radius 1, poles on y, with twice as many columns as rows. */
export function ball(rows: number): Model {
  const columns = 2 * rows;
  const positions = [0, 1, 0, 0, -1, 0];
  const indices: number[] = [];
  const at = (i: number, j: number) => 2 + (i - 1) * columns + (j % columns);
  for (let i = 1; i < rows; ++i)
    for (let j = 0; j < columns; ++j) {
      const [v, u] = [(Math.PI * i) / rows, (2 * Math.PI * j) / columns];
      positions.push(Math.sin(v) * Math.sin(u), Math.cos(v), Math.sin(v) * Math.cos(u));
    }
  for (let j = 0; j < columns; ++j) {
    indices.push(0, at(1, j), at(1, j + 1), 1, at(rows - 1, j + 1), at(rows - 1, j));
    for (let i = 1; i < rows - 1; ++i)
      indices.push(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1));
  }
  return [Float32Array.from(positions), indices];
}

/** Around y from −2 to 2, open at both ends. With a power above 2 its outline has corners. */
export function tube(rows: number, columns: number, radius: (y: number) => number, power = 2): Model {
  const positions: number[] = [];
  const indices: number[] = [];
  const at = (i: number, j: number) => i * columns + (j % columns);
  for (let i = 0; i <= rows; ++i)
    for (let j = 0; j < columns; ++j) {
      const [y, u] = [(4 * i) / rows - 2, (2 * Math.PI * j) / columns];
      const [x, z] = [Math.sin(u), Math.cos(u)];
      const r = radius(y) / (Math.abs(x) ** power + Math.abs(z) ** power) ** (1 / power);
      positions.push(r * x, y, r * z);
      if (i < rows)
        indices.push(at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i + 1, j));
    }
  return [Float32Array.from(positions), indices];
}

/** Half a tube: a sheet bent around y, with a rim all around. */
export function roll(rows = 20, columns = 40): Model {
  const positions: number[] = [];
  const indices: number[] = [];
  for (let i = 0; i <= rows; ++i)
    for (let j = 0; j <= columns; ++j) {
      const u = (Math.PI * j) / columns;
      positions.push(Math.cos(u), (2 * i) / rows - 1, Math.sin(u));
      const at = i * (columns + 1) + j;
      if (i < rows && j < columns)
        indices.push(at, at + 1, at + columns + 2, at, at + columns + 2, at + columns + 1);
    }
  return [Float32Array.from(positions), indices];
}

export const moved = ([positions, indices]: Model, by: Place3): Model => [
  positions.map((x, i) => x + (by[(i % 3) as 0 | 1 | 2] ?? 0)),
  indices,
];

export const both = ([a, ofA]: Model, [b, ofB]: Model): Model => [
  Float32Array.from([...a, ...b]),
  [...ofA, ...ofB.map((v) => v + a.length / 3)],
];

/** Of a chain, back to its first point where it is closed. */
export const lengthOf = ({ points, closed }: Chain): number => {
  const count = points.length / 3;
  let sum = 0;
  for (let i = closed ? 0 : 1; i < count; ++i) {
    const before = (i + count - 1) % count;
    sum += Math.hypot(...[0, 1, 2].map((k) => (points[3 * i + k] ?? 0) - (points[3 * before + k] ?? 0)));
  }
  return sum;
};

export const planeAcross = (normal: Place3, offset = 0): Plane => {
  const length = Math.hypot(...normal);
  return { normal: [normal[0] / length, normal[1] / length, normal[2] / length], offset };
};
