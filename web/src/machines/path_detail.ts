// SPDX-License-Identifier: GPL-3.0-or-later
// A tool path with fewer points, for pictures only: what is left out lies within a tolerance of the line that is drawn instead
// (Douglas and Peucker 1973, in pieces of a bounded number of points). What is sent, timed and said is always the path itself.
import type { PathDetail, ToolPath } from './toolpath';

/** Below this many points everything is drawn as it is. */
const fewPoints = 20_000;
const levels_mm = [0.02, 0.1, 0.5];
/** Splitting takes at worst the square of this. */
const piecePoints = 512;

export const pointCount = ({ paths }: ToolPath): number =>
  paths.reduce((sum, { times_s }) => sum + times_s.length, 0);

/** Square of the distance of point `p` from the line between points `a` and `b`. */
function distance2(points: ArrayLike<number>, p: number, a: number, b: number): number {
  const ax = points[3 * a] ?? 0;
  const ay = points[3 * a + 1] ?? 0;
  const az = points[3 * a + 2] ?? 0;
  const dx = (points[3 * b] ?? 0) - ax;
  const dy = (points[3 * b + 1] ?? 0) - ay;
  const dz = (points[3 * b + 2] ?? 0) - az;
  const px = (points[3 * p] ?? 0) - ax;
  const py = (points[3 * p + 1] ?? 0) - ay;
  const pz = (points[3 * p + 2] ?? 0) - az;
  const length2 = dx * dx + dy * dy + dz * dz;
  const t = length2 > 0 ? Math.min(1, Math.max(0, (px * dx + py * dy + pz * dz) / length2)) : 0;
  return (px - t * dx) ** 2 + (py - t * dy) ** 2 + (pz - t * dz) ** 2;
}

/** The numbers of the points that are needed. */
export function fewerPoints(points: ArrayLike<number>, tolerance_mm: number): Uint32Array<ArrayBuffer> {
  const count = points.length / 3;
  const needed = new Uint8Array(count);
  const limit = tolerance_mm * tolerance_mm;
  const spans: number[] = [];
  for (let from = 0; from < count - 1; from += piecePoints)
    spans.push(from, Math.min(count - 1, from + piecePoints));
  if (count > 0) needed[0] = needed[count - 1] = 1;
  for (
    let b = spans.pop(), a = spans.pop();
    a !== undefined && b !== undefined;
    b = spans.pop(), a = spans.pop()
  ) {
    needed[a] = needed[b] = 1;
    let [worst, farthest] = [-1, limit];
    for (let p = a + 1; p < b; ++p) {
      const distance = distance2(points, p, a, b);
      if (distance > farthest) [worst, farthest] = [p, distance];
    }
    if (worst >= 0) spans.push(a, worst, worst, b);
  }
  return Uint32Array.from(indicesOf(needed));
}

function* indicesOf(needed: Uint8Array): Generator<number> {
  for (let i = 0; i < needed.length; ++i) if (needed[i] === 1) yield i;
}

/** Coarser and coarser; none where the path has few points. */
export function detailsOf(toolPath: ToolPath): PathDetail[] {
  if (pointCount(toolPath) < fewPoints) return [];
  return levels_mm.map((tolerance_mm) => {
    const kept = toolPath.paths.map(({ points_mm }) =>
      points_mm.length <= 6 ? null : fewerPoints(points_mm, tolerance_mm),
    );
    const points = kept.reduce(
      (sum, some, i) => sum + (some?.length ?? toolPath.paths[i]?.times_s.length ?? 0),
      0,
    );
    return { tolerance_mm, kept, points };
  });
}

/**
 * What to draw where a pixel is `pixel_mm` wide: nothing is off by more than half a pixel, unless that took over `most` points.
 * Null: everything.
 */
export function detailFor(toolPath: ToolPath, pixel_mm: number, most = Infinity): PathDetail | null {
  const { details = [] } = toolPath;
  let level = details.findLastIndex(({ tolerance_mm }) => tolerance_mm <= pixel_mm / 2);
  if (level < 0 && details.length > 0 && pointCount(toolPath) > most) level = 0;
  while (level >= 0 && level + 1 < details.length && (details[level]?.points ?? 0) > most) ++level;
  return details[level] ?? null;
}
