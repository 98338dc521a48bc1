// SPDX-License-Identifier: GPL-3.0-or-later
// Bends the flat ribbon into the zipped one: every angle between neighbouring triangles grows from nothing to what it
// is in the end, and every edge keeps its length on the way. A picture of where the ribbon goes, not a simulation:
// it knows neither cloth nor collisions.
import type { Ribbon } from '../design';

interface Step {
  readonly parent: number;
  readonly triangle: number;
  /** The shared edge as the parent has it, and the corner beyond it. */
  readonly a: number;
  readonly b: number;
  readonly corner: number;
  /** Of the corner: along the edge, and away from it. */
  readonly along_mm: number;
  readonly away_mm: number;
  readonly angle: number;
}

type Vector = [number, number, number];
const cross = (a: Vector, b: Vector): Vector => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
const dot = (a: Vector, b: Vector) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const unit = (a: Vector): Vector => {
  const length = Math.hypot(...a);
  return length > 0 ? [a[0] / length, a[1] / length, a[2] / length] : [0, 0, 0];
};
const between = (positions: ArrayLike<number>, a: number, b: number): Vector => [
  (positions[3 * b] ?? 0) - (positions[3 * a] ?? 0),
  (positions[3 * b + 1] ?? 0) - (positions[3 * a + 1] ?? 0),
  (positions[3 * b + 2] ?? 0) - (positions[3 * a + 2] ?? 0),
];

export class Bending {
  readonly #ribbon: Ribbon;
  readonly #root: number;
  readonly #rootNormal: Vector;
  readonly #steps: Step[] = [];

  /** Needs a triangulated disc without inner vertices: its triangles then make a tree. */
  constructor(ribbon: Ribbon) {
    this.#ribbon = ribbon;
    const beyond = neighbours(ribbon.triangles);
    this.#root = middleOf(beyond);
    this.#rootNormal = this.#normal(this.#root);
    const seen = new Set([this.#root]);
    const queue = [{ triangle: this.#root, normal: this.#rootNormal }];
    for (const { triangle: parent, normal } of queue)
      for (let k = 0; k < 3; ++k) {
        const triangle = beyond[3 * parent + k] ?? -1;
        if (triangle < 0 || seen.has(triangle)) continue;
        seen.add(triangle);
        const step = this.#step(parent, k, triangle, normal);
        this.#steps.push(step);
        const away = cross(unit(between(ribbon.positions, step.a, step.b)), normal);
        queue.push({ triangle, normal: turned(normal, away, step.angle) });
      }
  }

  #corner(triangle: number, k: number): number {
    return this.#ribbon.triangles[3 * triangle + (k % 3)] ?? 0;
  }

  #normal(triangle: number): Vector {
    const [a, b, c] = [0, 1, 2].map((k) => this.#corner(triangle, k)) as [number, number, number];
    const { positions } = this.#ribbon;
    return unit(cross(between(positions, a, b), between(positions, a, c)));
  }

  #step(parent: number, k: number, triangle: number, normal: Vector): Step {
    const [a, b] = [this.#corner(parent, k), this.#corner(parent, k + 1)];
    const corner =
      [0, 1, 2].map((i) => this.#corner(triangle, i)).find((vertex) => vertex !== a && vertex !== b) ?? a;
    const { positions } = this.#ribbon;
    const edge = unit(between(positions, a, b));
    const away = cross(edge, normal);
    const to = between(positions, a, corner);
    const [out, up] = [dot(to, away), dot(to, normal)];
    const [along_mm, away_mm, angle] = [dot(to, edge), Math.hypot(out, up), Math.atan2(up, out)];
    return { parent, triangle, a, b, corner, along_mm, away_mm, angle };
  }

  /** x, y, z per vertex; 0 is flat, 1 zipped. The triangle in the middle stays where it is. */
  at(share: number): Float32Array {
    const positions = Float64Array.from(this.#ribbon.positions);
    const normals = new Map<number, Vector>([[this.#root, this.#rootNormal]]);
    for (const { parent, triangle, a, b, corner, along_mm, away_mm, angle } of this.#steps) {
      const normal = normals.get(parent) ?? this.#rootNormal;
      const edge = unit(between(positions, a, b));
      const away = cross(edge, normal);
      const [out, up] = [away_mm * Math.cos(share * angle), away_mm * Math.sin(share * angle)];
      for (let k = 0; k < 3; ++k)
        positions[3 * corner + k] =
          (positions[3 * a + k] ?? 0) +
          along_mm * (edge[k] ?? 0) +
          out * (away[k] ?? 0) +
          up * (normal[k] ?? 0);
      normals.set(triangle, turned(normal, away, share * angle));
    }
    return Float32Array.from(positions);
  }
}

const turned = (normal: Vector, away: Vector, angle: number): Vector => {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return [c * normal[0] - s * away[0], c * normal[1] - s * away[1], c * normal[2] - s * away[2]];
};

/** Per corner: the triangle beyond the edge from there to the next corner; −1 at the boundary. */
function neighbours(triangles: Uint32Array): Int32Array {
  const beyond = new Int32Array(triangles.length).fill(-1);
  const waiting = new Map<number, number>();
  const vertices = 1 + triangles.reduce((most, vertex) => Math.max(most, vertex), 0);
  triangles.forEach((from, at) => {
    const triangle = Math.floor(at / 3);
    const to = triangles[3 * triangle + ((at + 1) % 3)] ?? 0;
    const other = waiting.get(to * vertices + from);
    if (other === undefined) waiting.set(from * vertices + to, at);
    else {
      beyond[at] = Math.floor(other / 3);
      beyond[other] = triangle;
    }
  });
  return beyond;
}

/** Halfway along the longest way through the tree. */
function middleOf(beyond: Int32Array): number {
  const walk = (start: number): { order: number[]; from: Map<number, number> } => {
    const from = new Map([[start, -1]]);
    const order = [start];
    for (const triangle of order)
      for (let k = 0; k < 3; ++k) {
        const next = beyond[3 * triangle + k] ?? -1;
        if (next < 0 || from.has(next)) continue;
        from.set(next, triangle);
        order.push(next);
      }
    return { order, from };
  };
  const { order, from } = walk(walk(0).order.at(-1) ?? 0);
  const path: number[] = [];
  for (let at = order.at(-1) ?? -1; at >= 0; at = from.get(at) ?? -1) path.push(at);
  return path[Math.floor(path.length / 2)] ?? 0;
}
