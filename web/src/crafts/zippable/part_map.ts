// SPDX-License-Identifier: GPL-3.0-or-later
// Which part each triangle of the ribbon lies on, and how distorted each part is, from the parameterised model.
import type { Ribbon } from './design';

export interface ParameterisedMesh {
  readonly positions: Float32Array;
  readonly indices: Uint32Array;
  /** u, v in mm and segment, per vertex; vertices are apart where parts or a part's cut meet. */
  readonly attributes: Readonly<Record<string, Float32Array>>;
}

/** Nearest vertices of a surface: cells about as large as two edges. */
export class VertexGrid {
  readonly #cells = new Map<string, number[]>();
  readonly #positions: Float32Array;
  readonly #low: number[];
  readonly #size: number;
  readonly #widest: number;

  constructor(positions: Float32Array) {
    this.#positions = positions;
    const count = positions.length / 3;
    const bounds = [0, 1, 2].map((k) => {
      let [low, high] = [Infinity, -Infinity];
      for (let i = k; i < positions.length; i += 3) {
        low = Math.min(low, positions[i] ?? 0);
        high = Math.max(high, positions[i] ?? 0);
      }
      return [low, high] as const;
    });
    this.#low = bounds.map(([low]) => low);
    const longest = Math.max(...bounds.map(([low, high]) => high - low), 1e-9);
    this.#size = (2 * longest) / Math.max(1, Math.sqrt(count));
    this.#widest = Math.ceil(longest / this.#size) + 1;
    for (let v = 0; v < count; ++v) {
      const key = this.#cell(positions, 3 * v).join();
      const cell = this.#cells.get(key);
      if (cell) cell.push(v);
      else this.#cells.set(key, [v]);
    }
  }

  #cell(point: ArrayLike<number>, at: number): number[] {
    return this.#low.map((low, k) => Math.floor(((point[at + k] ?? 0) - low) / this.#size));
  }

  /** −1 where there is no vertex at all. */
  nearest(point: readonly [number, number, number]): number {
    const [x = 0, y = 0, z = 0] = this.#cell(point, 0);
    let best = -1;
    let least = Infinity;
    // What lies r cells away is at least r − 1 cells' lengths off.
    for (let r = 0; r <= 2 * this.#widest && !(least < ((r - 1) * this.#size) ** 2); ++r)
      for (let i = -r; i <= r; ++i)
        for (let j = -r; j <= r; ++j) {
          const whole = Math.abs(i) === r || Math.abs(j) === r;
          for (let k = -r; k <= r; k += whole ? 1 : Math.max(1, 2 * r))
            for (const v of this.#cells.get(`${x + i},${y + j},${z + k}`) ?? []) {
              const squared = [0, 1, 2].reduce(
                (sum, axis) => sum + ((this.#positions[3 * v + axis] ?? 0) - (point[axis] ?? 0)) ** 2,
                0,
              );
              if (squared < least) [least, best] = [squared, v];
            }
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
