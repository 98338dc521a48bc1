// SPDX-License-Identifier: GPL-3.0-or-later
/* eslint-disable @typescript-eslint/no-non-null-assertion -- indices stay within the arrays' own lengths */
// Which part each triangle of the ribbon lies on, and how distorted each part is, from the parameterised model.
import type { Ribbon } from '../design';

export interface ParameterisedMesh {
  readonly positions: Float32Array;
  readonly indices: Uint32Array;
  /** u, v in mm and segment, per vertex; vertices are apart where parts or a part's cut meet. */
  readonly attributes: Readonly<Record<string, Float32Array>>;
}

/** Nearest vertices of a surface: cells about as large as two edges. */
export class VertexGrid {
  readonly #positions: Float32Array;
  readonly #low: readonly number[];
  readonly #size: number;
  /** Cells along each axis. */
  readonly #count: readonly number[];
  /** The vertices of cell c are #vertices[#first[c]] up to #first[c + 1]. */
  readonly #first: Int32Array;
  readonly #vertices: Int32Array;

  constructor(positions: Float32Array) {
    this.#positions = positions;
    const vertices = positions.length / 3;
    const bounds = [0, 1, 2].map((k) => {
      let [low, high] = [Infinity, -Infinity];
      for (let i = k; i < positions.length; i += 3) {
        low = Math.min(low, positions[i] ?? 0);
        high = Math.max(high, positions[i] ?? 0);
      }
      return [low, high] as const;
    });
    const longest = Math.max(...bounds.map(([low, high]) => high - low), 1e-9);
    this.#low = bounds.map(([low]) => low);
    this.#size = (2 * longest) / Math.max(1, Math.sqrt(vertices));
    this.#count = bounds.map(([low, high]) => 1 + Math.max(0, Math.floor((high - low) / this.#size)));
    const cells = vertices === 0 ? 0 : this.#count.reduce((product, count) => product * count, 1);
    this.#first = new Int32Array(cells + 1);
    this.#vertices = new Int32Array(vertices);
    const cellOf = Int32Array.from({ length: vertices }, (_, v) => {
      const [i = 0, j = 0, k = 0] = this.#cell(positions, 3 * v);
      return this.#number(i, j, k);
    });
    for (const cell of cellOf) ++this.#first[cell + 1]!;
    for (let cell = 0; cell < cells; ++cell) this.#first[cell + 1]! += this.#first[cell]!;
    const next = this.#first.slice();
    cellOf.forEach((cell, v) => (this.#vertices[next[cell]!++] = v));
  }

  #cell(point: ArrayLike<number>, at: number): number[] {
    return this.#low.map((low, k) => Math.floor((point[at + k]! - low) / this.#size));
  }

  #number(i: number, j: number, k: number): number {
    return (i * this.#count[1]! + j) * this.#count[2]! + k;
  }

  /** −1 where there is no vertex at all. */
  nearest(point: readonly [number, number, number]): number {
    if (this.#vertices.length === 0) return -1;
    const [x = 0, y = 0, z = 0] = this.#cell(point, 0);
    const [nx, ny, nz] = this.#count as [number, number, number];
    let best = -1;
    let least = Infinity;
    const look = (cell: number) => {
      for (let at = this.#first[cell]!; at < this.#first[cell + 1]!; ++at) {
        const v = this.#vertices[at]!;
        let squared = 0;
        for (let axis = 0; axis < 3; ++axis) squared += (this.#positions[3 * v + axis]! - point[axis]!) ** 2;
        if (squared < least) [least, best] = [squared, v];
      }
    };
    // Shells of cells around the point's own; what lies r cells away is at least r − 1 cells' lengths off.
    // From outside the box of cells the search begins at its nearest cell's shell.
    const outside = (at: number, count: number) => Math.max(0, -at, at - count + 1);
    const reach = Math.max(x, nx - 1 - x, y, ny - 1 - y, z, nz - 1 - z);
    const start = Math.max(outside(x, nx), outside(y, ny), outside(z, nz));
    for (let r = start; r <= reach && !(least < ((r - 1) * this.#size) ** 2); ++r)
      for (let i = Math.max(0, x - r); i <= Math.min(nx - 1, x + r); ++i)
        for (let j = Math.max(0, y - r); j <= Math.min(ny - 1, y + r); ++j) {
          const face = Math.abs(i - x) === r || Math.abs(j - y) === r;
          if (face)
            for (let k = Math.max(0, z - r); k <= Math.min(nz - 1, z + r); ++k) look(this.#number(i, j, k));
          else for (const k of [z - r, z + r]) if (k >= 0 && k < nz) look(this.#number(i, j, k));
        }
    return best;
  }
}

/** Per triangle of the ribbon: the part of the vertex nearest to its centre. */
export function partsOfTriangles(ribbon: Ribbon, segment: Float32Array, grid: VertexGrid): Int32Array {
  return Int32Array.from({ length: ribbon.triangles.length / 3 }, (_, t) => {
    const centre = [0, 1, 2].map((k) => {
      const corner = (i: number) => ribbon.positions[3 * (ribbon.triangles[3 * t + i] ?? 0) + k] ?? 0;
      return (corner(0) + corner(1) + corner(2)) / 3;
    });
    const nearest = grid.nearest(centre as [number, number, number]);
    return segment[nearest] ?? 0;
  });
}

export interface PartDistortion {
  readonly area_mm2: number;
  /** Symmetric Dirichlet energy over 4, weighted by area; 1 is none. */
  readonly mean: number;
  readonly most: number;
}

/** Of every part, from the lengths and angles of its triangles in space and in u, v. */
export function distortionOfParts({ positions, indices, attributes }: ParameterisedMesh): PartDistortion[] {
  const { u, v, segment } = attributes;
  if (!u || !v || !segment) return [];
  const parts: { area_mm2: number; sum: number; most: number }[] = [];
  for (let at = 0; at < indices.length; at += 3) {
    const [a = 0, b = 0, c = 0] = indices.subarray(at, at + 3);
    const side = (to: number) =>
      [0, 1, 2].map((k) => (positions[3 * to + k] ?? 0) - (positions[3 * a + k] ?? 0));
    const [p, q] = [side(b), side(c)];
    const product = (x: number[], y: number[]) => x.reduce((sum, value, k) => sum + value * (y[k] ?? 0), 0);
    // The first side lies along x; the second is (qx, qy) in the triangle's plane.
    const px = Math.sqrt(product(p, p));
    const qx = px > 0 ? product(p, q) / px : 0;
    const qy = Math.sqrt(Math.max(0, product(q, q) - qx * qx));
    const [bu, bv] = [(u[b] ?? 0) - (u[a] ?? 0), (v[b] ?? 0) - (v[a] ?? 0)];
    const [cu, cv] = [(u[c] ?? 0) - (u[a] ?? 0), (v[c] ?? 0) - (v[a] ?? 0)];
    const area_mm2 = (px * qy) / 2;
    const determinant = area_mm2 > 0 ? (bu * cv - bv * cu) / (2 * area_mm2) : 0;
    const part = (parts[segment[a] ?? 0] ??= { area_mm2: 0, sum: 0, most: 1 });
    if (determinant === 0) continue;
    const j = [bu / px, bv / px, (cu - (qx * bu) / px) / qy, (cv - (qx * bv) / px) / qy];
    const squared = product(j, j);
    const energy = (squared + squared / determinant ** 2) / 4;
    part.area_mm2 += area_mm2;
    part.sum += area_mm2 * energy;
    part.most = Math.max(part.most, energy);
  }
  return Array.from(parts, (part) =>
    part
      ? { area_mm2: part.area_mm2, mean: part.area_mm2 > 0 ? part.sum / part.area_mm2 : 1, most: part.most }
      : { area_mm2: 0, mean: 1, most: 1 },
  );
}
