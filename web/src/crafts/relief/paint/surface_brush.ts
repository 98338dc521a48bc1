// SPDX-License-Identifier: GPL-3.0-or-later
// Which vertices a brush covers: those that are connected to the place under it within its radius. So it does not paint
// through a thin sheet. And larger choices that need no hand: parts, sides, the outline.
import type { Vec3 } from '../../../view';

const addTo = (values: Uint32Array, at: number, more: number) => {
  values[at] = (values[at] ?? 0) + more;
};

export class SurfaceBrush {
  readonly #positions: Float32Array;
  readonly #indices: Uint32Array;
  /** Neighbours of vertex v: from start[v] to start[v + 1]. */
  readonly #start: Uint32Array;
  readonly #neighbours: Uint32Array;
  readonly #stamp: Uint32Array;
  #stamps = 0;

  /** `positions`: x, y, z per vertex, in the units of centre and radius. */
  constructor(positions: Float32Array, indices: Uint32Array) {
    this.#positions = positions;
    this.#indices = indices;
    const n = positions.length / 3;
    this.#start = new Uint32Array(n + 1);
    this.#stamp = new Uint32Array(n);
    const { length } = indices;
    for (const v of indices) addTo(this.#start, v + 1, 2);
    for (let v = 0; v < n; ++v) addTo(this.#start, v + 1, this.#start[v] ?? 0);
    this.#neighbours = new Uint32Array(2 * length);
    const next = this.#start.slice(0, n);
    for (let t = 0; t < length; t += 3)
      for (let k = 0; k < 3; ++k) {
        const v = indices[t + k] ?? 0;
        for (const other of [(k + 1) % 3, (k + 2) % 3]) {
          this.#neighbours[next[v] ?? 0] = indices[t + other] ?? 0;
          addTo(next, v, 1);
        }
      }
  }

  get vertices(): number {
    return this.#positions.length / 3;
  }

  /** Around a point of a triangle; at least the triangle's nearest corner. */
  within(triangle: number, centre: Vec3, radius: number): number[] {
    const corners = [0, 1, 2].map((k) => this.#indices[3 * triangle + k] ?? 0);
    const away = (v: number) => this.#distance(v, centre);
    const near = corners.filter((v) => away(v) <= radius);
    if (near.length === 0) return corners.sort((a, b) => away(a) - away(b)).slice(0, 1);
    return this.#flood(near, (v) => away(v) <= radius);
  }

  /** Everything that is connected to a triangle. */
  part(triangle: number): number[] {
    return this.#flood([this.#indices[3 * triangle] ?? 0], () => true);
  }

  /** Vertices all of whose triangles face the eye (`facing`), face away (`away`), or both kinds meet (`outline`).
   *  `towards`: from a point of the surface to the eye. */
  side(which: 'facing' | 'away' | 'outline', towards: (at: Vec3) => Vec3): number[] {
    const seen = new Uint8Array(this.vertices);
    for (let t = 0; t < this.#indices.length; t += 3) {
      const [a, b, c] = [0, 1, 2].map((k) => this.#indices[t + k] ?? 0) as [number, number, number];
      const [p, q, r] = [this.#at(a), this.#at(b), this.#at(c)];
      const u = q.map((x, k) => x - p[k as 0]) as unknown as Vec3;
      const v = r.map((x, k) => x - p[k as 0]) as unknown as Vec3;
      const normal: Vec3 = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
      const eye = towards(p);
      const flag = normal[0] * eye[0] + normal[1] * eye[1] + normal[2] * eye[2] > 0 ? 1 : 2;
      for (const corner of [a, b, c]) seen[corner] = (seen[corner] ?? 0) | flag;
    }
    const wanted = { facing: 1, away: 2, outline: 3 }[which];
    const found: number[] = [];
    seen.forEach((flags, vertex) => flags === wanted && found.push(vertex));
    return found;
  }

  #at(v: number): Vec3 {
    return [this.#positions[3 * v] ?? 0, this.#positions[3 * v + 1] ?? 0, this.#positions[3 * v + 2] ?? 0];
  }

  #distance(v: number, [x, y, z]: Vec3): number {
    const [a, b, c] = this.#at(v);
    return Math.hypot(a - x, b - y, c - z);
  }

  #flood(seeds: readonly number[], inside: (v: number) => boolean): number[] {
    const stamp = ++this.#stamps;
    const found = [...seeds];
    for (const v of seeds) this.#stamp[v] = stamp;
    for (let i = 0; i < found.length; ++i) {
      const v = found[i] ?? 0;
      for (let k = this.#start[v] ?? 0; k < (this.#start[v + 1] ?? 0); ++k) {
        const next = this.#neighbours[k] ?? 0;
        if (this.#stamp[next] === stamp || !inside(next)) continue;
        this.#stamp[next] = stamp;
        found.push(next);
      }
    }
    return found;
  }
}
