// SPDX-License-Identifier: GPL-3.0-or-later
/* eslint-disable @typescript-eslint/no-non-null-assertion -- indices stay within the arrays' own lengths */
// How a border will run between its points, for the eye: the nearest way along the edges, smoothed. The core finds its own.
import type { Place3 } from './drawn_parts';
import { VertexGrid } from '../ribbon/part_map';

const smoothings = 12;

export class SurfaceGraph {
  readonly #positions: Float32Array;
  readonly #grid: VertexGrid;
  /** Neighbours of vertex v are #neighbours[#first[v]] up to #first[v + 1]. */
  readonly #first: Int32Array;
  readonly #neighbours: Int32Array;
  readonly #way: Float64Array;
  readonly #from: Int32Array;
  /** Raised at every search, so that nothing has to be cleared. */
  readonly #seen: Int32Array;
  #search = 0;

  constructor(positions: Float32Array, indices: ArrayLike<number>) {
    const count = positions.length / 3;
    this.#positions = positions;
    this.#grid = new VertexGrid(positions);
    this.#first = new Int32Array(count + 1);
    for (let i = 0; i < indices.length; ++i) this.#first[indices[i]! + 1]! += 2;
    for (let v = 0; v < count; ++v) this.#first[v + 1]! += this.#first[v]!;
    const next = this.#first.slice();
    this.#neighbours = new Int32Array(2 * indices.length);
    for (let i = 0; i < indices.length; i += 3)
      for (let k = 0; k < 3; ++k) {
        const [a, b] = [indices[i + k]!, indices[i + ((k + 1) % 3)]!];
        this.#neighbours[next[a]!++] = b;
        this.#neighbours[next[b]!++] = a;
      }
    this.#way = new Float64Array(count);
    this.#from = new Int32Array(count);
    this.#seen = new Int32Array(count);
  }

  #between(a: number, b: number): number {
    const p = this.#positions;
    return Math.hypot(p[3 * a]! - p[3 * b]!, p[3 * a + 1]! - p[3 * b + 1]!, p[3 * a + 2]! - p[3 * b + 2]!);
  }

  /** Vertices from `start` to `end`, by A*; both alone where there is no way. */
  #vertices(start: number, end: number): number[] {
    const search = ++this.#search;
    const heap = new Heap();
    this.#seen[start] = search;
    this.#way[start] = 0;
    this.#from[start] = -1;
    heap.push(start, 0);
    for (let v = heap.pop(); v >= 0; v = heap.pop()) {
      if (v === end) {
        const way: number[] = [];
        for (let at = end; at >= 0; at = this.#from[at]!) way.push(at);
        return way.reverse();
      }
      for (let i = this.#first[v]!; i < this.#first[v + 1]!; ++i) {
        const w = this.#neighbours[i]!;
        const way = this.#way[v]! + this.#between(v, w);
        if (this.#seen[w] === search && !(way < this.#way[w]!)) continue;
        this.#seen[w] = search;
        this.#way[w] = way;
        this.#from[w] = v;
        heap.push(w, way + this.#between(w, end));
      }
    }
    return [start, end];
  }

  /** Ways found before: while a point is dragged only the two that it ends are sought again. */
  readonly #known = new WeakMap<Place3, WeakMap<Place3, readonly number[]>>();

  /** x, y, z of the points on the way, both ends exactly. */
  path(a: Place3, b: Place3): readonly number[] {
    const from = this.#known.get(a) ?? new WeakMap<Place3, readonly number[]>();
    this.#known.set(a, from);
    const known = from.get(b);
    if (known !== undefined) return known;
    const way = this.#newPath(a, b);
    from.set(b, way);
    return way;
  }

  #newPath(a: Place3, b: Place3): number[] {
    const [start, end] = [this.#grid.nearest(a), this.#grid.nearest(b)];
    if (start < 0 || end < 0) return [...a, ...b];
    const between = this.#vertices(start, end).flatMap((v) => [
      ...this.#positions.subarray(3 * v, 3 * v + 3),
    ]);
    const line = [...a, ...between, ...b];
    for (let round = 0; round < smoothings; ++round)
      for (let i = 3; i < line.length - 3; ++i)
        line[i] = 0.25 * line[i - 3]! + 0.5 * line[i]! + 0.25 * line[i + 3]!;
    return line;
  }

  /** Through all points, and back to the first where it is closed. */
  through(points: readonly Place3[], closed: boolean): Float32Array {
    const line: number[] = [];
    const ends = closed && points.length > 1 ? [...points, points[0]!] : points;
    for (let i = 0; i + 1 < ends.length; ++i) line.push(...this.path(ends[i]!, ends[i + 1]!));
    return Float32Array.from(line);
  }
}

/** Smallest key first; what was bettered since stays in and is met again without harm. */
class Heap {
  readonly #items: number[] = [];
  readonly #keys: number[] = [];

  push(item: number, key: number): void {
    let at = this.#items.length;
    for (let up = (at - 1) >> 1; at > 0 && this.#keys[up]! > key; at = up, up = (at - 1) >> 1) {
      this.#items[at] = this.#items[up]!;
      this.#keys[at] = this.#keys[up]!;
    }
    this.#items[at] = item;
    this.#keys[at] = key;
  }

  /** −1 when it is empty. */
  pop(): number {
    const top = this.#items[0];
    const [item, key] = [this.#items.pop(), this.#keys.pop()];
    if (top === undefined || item === undefined || key === undefined) return -1;
    const count = this.#items.length;
    if (count === 0) return top;
    let at = 0;
    for (;;) {
      let down = 2 * at + 1;
      if (down + 1 < count && this.#keys[down + 1]! < this.#keys[down]!) ++down;
      if (down >= count || this.#keys[down]! >= key) break;
      this.#items[at] = this.#items[down]!;
      this.#keys[at] = this.#keys[down]!;
      at = down;
    }
    this.#items[at] = item;
    this.#keys[at] = key;
    return top;
  }
}
