// SPDX-License-Identifier: GPL-3.0-or-later
// Scattered points of the sheet as a surface: triangles between neighbours, and values between points.
import Delaunator from 'delaunator';
import type { Frame } from './frame';
import type { Residuals } from './residuals';
import { percentile } from './residuals';

/** Three points per triangle, counter-clockwise seen from above. Gaps of the data stay open: triangles with sides much longer
 *  than usual are left out. */
export function triangulate({ sheet, count }: Pick<Residuals, 'sheet' | 'count'>): Uint32Array {
  if (count < 3) return new Uint32Array(0);
  const { triangles } = new Delaunator(sheet);
  const length = (a: number, b: number) =>
    Math.hypot((sheet[2 * a] ?? 0) - (sheet[2 * b] ?? 0), (sheet[2 * a + 1] ?? 0) - (sheet[2 * b + 1] ?? 0));
  const longest = new Float64Array(triangles.length / 3);
  for (let t = 0; t < longest.length; ++t) {
    const [a = 0, b = 0, c = 0] = triangles.subarray(3 * t, 3 * t + 3);
    longest[t] = Math.max(length(a, b), length(b, c), length(c, a));
  }
  const limit = 4 * percentile(longest, 0.5);
  const kept: number[] = [];
  for (let t = 0; t < longest.length; ++t) {
    if ((longest[t] ?? 0) > limit) continue;
    const [a = 0, b = 0, c = 0] = triangles.subarray(3 * t, 3 * t + 3);
    const turn =
      ((sheet[2 * b] ?? 0) - (sheet[2 * a] ?? 0)) * ((sheet[2 * c + 1] ?? 0) - (sheet[2 * a + 1] ?? 0)) -
      ((sheet[2 * c] ?? 0) - (sheet[2 * a] ?? 0)) * ((sheet[2 * b + 1] ?? 0) - (sheet[2 * a + 1] ?? 0));
    kept.push(...(turn > 0 ? [a, b, c] : [a, c, b]));
  }
  return Uint32Array.from(kept);
}

/** Linear between the points of each triangle; NaN where there is none. */
export function rasterise(
  sheet: Float64Array,
  triangles: Uint32Array,
  values: Float64Array,
  frame: Frame,
): Float32Array {
  const { widthPx, heightPx, pixelsPerMm, left_mm, top_mm } = frame;
  const raster = new Float32Array(widthPx * heightPx).fill(NaN);
  const px = (i: number): [number, number] => [
    ((sheet[2 * i] ?? 0) - left_mm) * pixelsPerMm,
    (top_mm - (sheet[2 * i + 1] ?? 0)) * pixelsPerMm,
  ];
  for (let t = 0; t < triangles.length; t += 3) {
    const [a = 0, b = 0, c = 0] = triangles.subarray(t, t + 3);
    const [[ax, ay], [bx, by], [cx, cy]] = [px(a), px(b), px(c)];
    const area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
    if (Math.abs(area) < 1e-12) continue;
    const rows = [Math.floor(Math.min(ay, by, cy)), Math.ceil(Math.max(ay, by, cy))] as const;
    const columns = [Math.floor(Math.min(ax, bx, cx)), Math.ceil(Math.max(ax, bx, cx))] as const;
    for (let row = Math.max(0, rows[0]); row < Math.min(heightPx, rows[1]); ++row)
      for (let column = Math.max(0, columns[0]); column < Math.min(widthPx, columns[1]); ++column) {
        const [x, y] = [column + 0.5, row + 0.5];
        const u = ((bx - x) * (cy - y) - (cx - x) * (by - y)) / area;
        const v = ((cx - x) * (ay - y) - (ax - x) * (cy - y)) / area;
        const w = 1 - u - v;
        if (u < -1e-9 || v < -1e-9 || w < -1e-9) continue;
        raster[row * widthPx + column] = u * (values[a] ?? 0) + v * (values[b] ?? 0) + w * (values[c] ?? 0);
      }
  }
  return raster;
}
