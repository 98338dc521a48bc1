// SPDX-License-Identifier: GPL-3.0-or-later
/* eslint-disable @typescript-eslint/no-non-null-assertion -- indices stay within the arrays' own lengths */
// The ribbon's triangles cut along the borders of the parts: the ribbon's own reach from side to side across them.
import type { Ribbon } from '../design';
import type { PartBorders } from './part_borders';

export interface RibbonPieces {
  /** Three vertex numbers per piece; those beyond the ribbon's are the points that follow. */
  readonly triangles: Uint32Array;
  /** Per piece: the triangle of the ribbon that it is of, and its part. */
  readonly of: Uint32Array;
  readonly part: Int32Array;
  /** Of each further point: three vertices of the ribbon and their weights. */
  readonly corners: Uint32Array;
  readonly weights: Float32Array;
}

type Weights = readonly number[];
/** Of a triangle's size: nearer points are one. */
const nearly = 1e-5;

/** The part of a convex polygon where `value` is not negative; it is linear. */
function clipped(polygon: readonly Weights[], value: (at: Weights) => number): Weights[] {
  const kept: Weights[] = [];
  polygon.forEach((here, i) => {
    const next = polygon[(i + 1) % polygon.length]!;
    const [v, w] = [value(here), value(next)];
    if (v >= 0) kept.push(here);
    if (v >= 0 === w >= 0) return;
    const share = v / (v - w);
    kept.push(here.map((weight, k) => weight + share * (next[k]! - weight)));
  });
  return kept;
}

const corner = (k: number): Weights => [0, 1, 2].map((i) => (i === k ? 1 : 0));

export function cutByParts(
  { positions, triangles }: Ribbon,
  partOfTriangle: Int32Array,
  borders: PartBorders,
): RibbonPieces {
  const count = positions.length / 3;
  const pointOf = (v: number) => [positions[3 * v]!, positions[3 * v + 1]!, positions[3 * v + 2]!] as const;
  const partOf = Int32Array.from({ length: count }, (_, v) => borders.partAt(pointOf(v)));
  const known = new Map<number, number>();
  const parts = 1 + Math.max(0, ...partOf, ...partOfTriangle);
  const deeper = (v: number, part: number, other: number): number => {
    const key = (v * parts + part) * parts + other;
    let value = known.get(key);
    if (value === undefined) known.set(key, (value = borders.deeper(pointOf(v), part, other, partOf[v]!)));
    return value;
  };
  const made = { triangles: [] as number[], of: [] as number[], part: [] as number[] };
  const further = { corners: [] as number[], weights: [] as number[] };
  const numbers = new Map<string, number>();
  /** The triangles at an edge share the points on it. */
  const numbered = (t: readonly number[], at: Weights): number => {
    const own = at.findIndex((weight) => weight > 1 - nearly);
    if (own >= 0) return t[own]!;
    const named = t.flatMap((v, k) => (at[k]! > nearly ? [`${v}:${at[k]!.toFixed(4)}`] : []));
    const key = named.sort().join();
    const before = numbers.get(key);
    if (before !== undefined) return before;
    further.corners.push(...t);
    further.weights.push(...at);
    const added = count + numbers.size;
    numbers.set(key, added);
    return added;
  };
  partOfTriangle.forEach((middle, at) => {
    const t = [triangles[3 * at]!, triangles[3 * at + 1]!, triangles[3 * at + 2]!];
    const among = [...new Set([middle, ...t.map((v) => partOf[v]!)])];
    for (const part of among) {
      let polygon: Weights[] = [0, 1, 2].map(corner);
      for (const other of among) {
        if (other === part) continue;
        const over = t.map((v) => deeper(v, part, other));
        polygon = clipped(polygon, (w) => w[0]! * over[0]! + w[1]! * over[1]! + w[2]! * over[2]!);
      }
      if (polygon.length < 3) continue;
      const around = polygon.map((weights) => numbered(t, weights));
      for (let k = 2; k < around.length; ++k) {
        made.triangles.push(around[0]!, around[k - 1]!, around[k]!);
        made.of.push(at);
        made.part.push(part);
      }
    }
  });
  return {
    triangles: Uint32Array.from(made.triangles),
    of: Uint32Array.from(made.of),
    part: Int32Array.from(made.part),
    corners: Uint32Array.from(further.corners),
    weights: Float32Array.from(further.weights),
  };
}

/** Values of the ribbon's vertices, `size` each, and after them those of the further points. */
export function withCutPoints(
  values: Float32Array,
  size: number,
  { corners, weights }: RibbonPieces,
): Float32Array {
  const points = corners.length / 3;
  const all = new Float32Array(values.length + size * points);
  all.set(values);
  for (let i = 0; i < points; ++i)
    for (let k = 0; k < size; ++k) {
      let sum = 0;
      for (let c = 3 * i; c < 3 * i + 3; ++c) sum += weights[c]! * values[size * corners[c]! + k]!;
      all[values.length + size * i + k] = sum;
    }
  return all;
}
