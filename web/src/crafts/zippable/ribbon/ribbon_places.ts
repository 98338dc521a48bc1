// SPDX-License-Identifier: GPL-3.0-or-later
// Places on the ribbon, the same in the plane and in space: a triangle and the weights of its corners.
import type { Design, Ribbon } from '../design';

export interface Place {
  readonly triangle: number;
  readonly weights: readonly [number, number, number];
}

type Point = readonly [number, number, number];

const cornersOf = ({ triangles }: Ribbon, t: number): [number, number, number] => [
  triangles[3 * t] ?? 0,
  triangles[3 * t + 1] ?? 0,
  triangles[3 * t + 2] ?? 0,
];

function blend(
  ribbon: Ribbon,
  values: ArrayLike<number>,
  size: number,
  { triangle, weights }: Place,
): number[] {
  const corners = cornersOf(ribbon, triangle);
  return Array.from({ length: size }, (_, k) =>
    corners.reduce((sum, v, i) => sum + (weights[i] ?? 0) * (values[size * v + k] ?? 0), 0),
  );
}

/** Where a place is in space; `positions` where the ribbon is bent otherwise than zipped. */
export const positionOf = (ribbon: Ribbon, place: Place, positions = ribbon.positions): Point =>
  blend(ribbon, positions, 3, place) as unknown as Point;

export const flatOf = (ribbon: Ribbon, place: Place): [number, number] =>
  blend(ribbon, ribbon.flat, 2, place) as [number, number];

/** The place under a point of the plane, mm: the topmost where the ribbon lies over itself; null beside it. */
export function placeInFlat(ribbon: Ribbon, x: number, y: number): Place | null {
  const { flat } = ribbon;
  for (let t = ribbon.triangles.length / 3 - 1; t >= 0; --t) {
    const [a, b, c] = cornersOf(ribbon, t);
    const [ax, ay] = [flat[2 * a] ?? 0, flat[2 * a + 1] ?? 0];
    const [bx, by] = [(flat[2 * b] ?? 0) - ax, (flat[2 * b + 1] ?? 0) - ay];
    const [cx, cy] = [(flat[2 * c] ?? 0) - ax, (flat[2 * c + 1] ?? 0) - ay];
    const area = bx * cy - by * cx;
    if (area === 0) continue;
    const second = ((x - ax) * cy - (y - ay) * cx) / area;
    const third = (bx * (y - ay) - by * (x - ax)) / area;
    if (second >= 0 && third >= 0 && second + third <= 1)
      return { triangle: t, weights: [1 - second - third, second, third] };
  }
  return null;
}

/** The place nearest to a point in space, mm; null for a ribbon without triangles. */
export function placeInSpace(ribbon: Ribbon, point: Point, positions = ribbon.positions): Place | null {
  let best: Place | null = null;
  let least = Infinity;
  for (let t = 0; t < ribbon.triangles.length / 3; ++t) {
    const weights = nearestWeights(point, ...cornersOf(ribbon, t), positions);
    const at = blend(ribbon, positions, 3, { triangle: t, weights });
    const squared = at.reduce((sum, value, k) => sum + (value - (point[k] ?? 0)) ** 2, 0);
    if (squared < least) [least, best] = [squared, { triangle: t, weights }];
  }
  return best;
}

/** Of the point of a triangle nearest to `p`: C. Ericson, Real-Time Collision Detection, 2005, Sec. 5.1.5. */
function nearestWeights(
  p: Point,
  a: number,
  b: number,
  c: number,
  positions: Float32Array,
): [number, number, number] {
  const from = (i: number, k: number) => positions[3 * i + k] ?? 0;
  let [d1, d2, abab, abac, acac] = [0, 0, 0, 0, 0];
  for (let k = 0; k < 3; ++k) {
    const [ab, ac, ap] = [from(b, k) - from(a, k), from(c, k) - from(a, k), (p[k] ?? 0) - from(a, k)];
    d1 += ab * ap;
    d2 += ac * ap;
    abab += ab * ab;
    abac += ab * ac;
    acac += ac * ac;
  }
  const [d3, d4, d5, d6] = [d1 - abab, d2 - abac, d1 - abac, d2 - acac];
  if (d1 <= 0 && d2 <= 0) return [1, 0, 0];
  if (d3 >= 0 && d4 <= d3) return [0, 1, 0];
  const vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return [1 - d1 / (d1 - d3), d1 / (d1 - d3), 0];
  if (d6 >= 0 && d5 <= d6) return [0, 0, 1];
  const vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return [1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)];
  const va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const w = (d4 - d3) / (d4 - d3 + (d5 - d6));
    return [0, 1 - w, w];
  }
  const sum = va + vb + vc;
  return sum > 0 ? [va / sum, vb / sum, vc / sum] : [1, 0, 0];
}

/** How far along the zipper a place is, mm: at the seam nearest to it; null where only openings are near. */
export function alongAt({ ribbon, along_mm }: Design, { triangle, weights }: Place): number | null {
  let most = -1;
  let along: number | null = null;
  cornersOf(ribbon, triangle).forEach((v, i) => {
    const sample = ribbon.sample[v] ?? -1;
    const weight = weights[i] ?? 0;
    if (sample >= 0 && weight > most) [most, along] = [weight, along_mm[sample] ?? 0];
  });
  return along;
}

/** The two places that the zipper brings together so far from its start, mm: left side, right side. */
export function seamAt({ ribbon, along_mm, pieceOf }: Design, wanted_mm: number): Place[] {
  let nearest = 0;
  along_mm.forEach((along, sample) => {
    const better = Math.abs(along - wanted_mm) < Math.abs((along_mm[nearest] ?? 0) - wanted_mm);
    if (better && (pieceOf[sample] ?? -1) >= 0) nearest = sample;
  });
  const places: Place[] = [];
  for (const side of [1, -1]) {
    const vertex = ribbon.sample.findIndex((sample, v) => sample === nearest && ribbon.side[v] === side);
    const at = vertex < 0 ? -1 : ribbon.triangles.indexOf(vertex);
    if (at < 0) continue;
    const weights = [0, 1, 2].map((k) => (k === at % 3 ? 1 : 0)) as [number, number, number];
    places.push({ triangle: Math.floor(at / 3), weights });
  }
  return places;
}
