// SPDX-License-Identifier: GPL-3.0-or-later
// A ribbon for tests: a strip wound once around a cylinder, unfolded triangle by triangle.
import type { Design } from '../design';
import { readDesign } from '../design';

type Point = [number, number, number];
const distance = (a: readonly number[], b: readonly number[]) =>
  Math.hypot(...a.map((value, k) => value - (b[k] ?? 0)));

/** `steps` quadrilaterals of a strip that climbs as it goes around; samples 0 to `steps` on both sides. */
export function woundStrip(steps = 12, radius_mm = 30, width_mm = 10): string {
  const point = (i: number, height: number): Point => {
    const angle = (2 * Math.PI * i) / steps;
    return [radius_mm * Math.cos(angle), radius_mm * Math.sin(angle), 5 * angle + height];
  };
  const count = steps + 1;
  // Counter-clockwise: along the lower side, back along the upper one.
  const positions = Array.from({ length: 2 * count }, (_, v) =>
    v < count ? point(v, 0) : point(2 * count - 1 - v, width_mm),
  );
  const upper = (i: number) => 2 * count - 1 - i;
  const triangles = Array.from({ length: steps }, (_, i) => [
    [i, i + 1, upper(i)],
    [i + 1, upper(i + 1), upper(i)],
  ]).flat();
  const at = (v: number): Point => positions[v] ?? [0, 0, 0];
  const flat: number[][] = [];
  flat[0] = [0, 0];
  flat[1] = [distance(at(0), at(1)), 0];
  for (const triangle of triangles) {
    const k = triangle.findIndex((v) => flat[v] === undefined);
    if (k < 0) continue;
    const [c = 0, a = 0, b = 0] = [0, 1, 2].map((i) => triangle[(k + i) % 3] ?? 0);
    const [p = [0, 0], q = [0, 0]] = [flat[a], flat[b]];
    const [edge, fromA, fromB] = [distance(p, q), distance(at(a), at(c)), distance(at(b), at(c))];
    const along = (fromA ** 2 - fromB ** 2 + edge ** 2) / (2 * edge);
    const away = Math.sqrt(fromA ** 2 - along ** 2);
    const [ex, ey] = [((q[0] ?? 0) - (p[0] ?? 0)) / edge, ((q[1] ?? 0) - (p[1] ?? 0)) / edge];
    flat[c] = [(p[0] ?? 0) + along * ex - away * ey, (p[1] ?? 0) + along * ey + away * ex];
  }
  const boundary = positions.map((position_mm, v) => ({
    position_mm,
    flat_mm: flat[v],
    zipper_sample: v < count ? v : upper(v),
    side: v < count ? 'left' : 'right',
  }));
  return JSON.stringify({
    format: 'formwright zippable design',
    version: 1,
    order: [0],
    parts: [{ period_mm: 2 * Math.PI * radius_mm, height_mm: width_mm, windings: 1 }],
    handles_cut: 0,
    zipper_mm: steps * distance(at(0), at(1)),
    pieces: [Array.from({ length: count }, (_, i) => i)],
    ribbon: { boundary, triangles },
  });
}

export const woundDesign = (steps?: number): Design =>
  readDesign(new TextEncoder().encode(woundStrip(steps)));
