// SPDX-License-Identifier: GPL-3.0-or-later
import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { detailFor, detailsOf, fewerPoints, pointCount } from './path_detail';
import type { ToolPath } from './toolpath';

type Point = readonly [number, number, number];

function distance(p: Point, a: Point, b: Point): number {
  const d = [b[0] - a[0], b[1] - a[1], b[2] - a[2]] as const;
  const w = [p[0] - a[0], p[1] - a[1], p[2] - a[2]] as const;
  const length2 = d[0] ** 2 + d[1] ** 2 + d[2] ** 2;
  const along = w[0] * d[0] + w[1] * d[1] + w[2] * d[2];
  const t = length2 > 0 ? Math.min(1, Math.max(0, along / length2)) : 0;
  return Math.hypot(w[0] - t * d[0], w[1] - t * d[1], w[2] - t * d[2]);
}

function toolPathOf(points: readonly Point[]): ToolPath {
  const part = {
    kind: 'work' as const,
    layer: 'finish',
    part: '',
    pass: 1,
    power_percent: 100,
    speed_mm_per_s: 10,
    points_mm: Float64Array.from(points.flat()),
    times_s: Float64Array.from(points, (_, i) => i),
    lines: Uint32Array.from(points, (_, i) => i),
  };
  return { bed_mm: [100, 100], no_go_mm: [], seconds: points.length, paths: [part] };
}

/** Lines to and fro over waves. */
const waves = (rows: number, columns: number): Point[] =>
  Array.from({ length: rows * columns }, (_, i) => {
    const row = Math.floor(i / columns);
    const column = row % 2 === 0 ? i % columns : columns - 1 - (i % columns);
    return [0.1 * column, 0.4 * row, Math.sin(0.03 * column) * Math.cos(0.1 * row)];
  });

describe('a tool path with fewer points', () => {
  it('has every point that was left out within the tolerance of its line, and both ends', () => {
    const point = fc.tuple(
      fc.double({ min: -50, max: 50, noNaN: true }),
      fc.double({ min: -50, max: 50, noNaN: true }),
      fc.double({ min: -5, max: 0, noNaN: true }),
    );
    fc.assert(
      fc.property(
        fc.array(point, { minLength: 2, maxLength: 60 }),
        fc.double({ min: 0.01, max: 20, noNaN: true }),
        (points, tolerance) => {
          const at = (i: number): Point => points[i] ?? [NaN, NaN, NaN];
          const kept = [...fewerPoints(points.flat(), tolerance)];
          expect(kept[0]).toBe(0);
          expect(kept.at(-1)).toBe(points.length - 1);
          for (let i = 1; i < kept.length; ++i) {
            const [a, b] = [kept[i - 1] ?? 0, kept[i] ?? 0];
            expect(b).toBeGreaterThan(a);
            for (let p = a; p <= b; ++p)
              expect(distance(at(p), at(a), at(b))).toBeLessThanOrEqual(tolerance * (1 + 1e-9));
          }
        },
      ),
    );
  });

  it('is bounded work on a path of a hundred thousand points, and far shorter', () => {
    const path = toolPathOf(waves(100, 1000));
    const details = detailsOf(path);
    expect(details).toHaveLength(3);
    expect(details[0]?.points).toBeLessThan(pointCount(path) / 5);
    for (const [i, { points }] of details.entries())
      if (i > 0) expect(points).toBeLessThan(details[i - 1]?.points ?? 0);
  });

  it('is left as it is where there are few points', () => {
    expect(detailsOf(toolPathOf(waves(10, 100)))).toEqual([]);
  });

  it('is chosen by half a pixel, coarser where there would be too many points', () => {
    const path = toolPathOf(waves(30, 1000));
    const details = detailsOf(path);
    const whole = { ...path, details };
    expect(detailFor(path, 1)).toBeNull();
    expect(detailFor(whole, 0.01)).toBeNull();
    expect(detailFor(whole, 0.05)).toBe(details[0]);
    expect(detailFor(whole, 0.3)).toBe(details[1]);
    expect(detailFor(whole, 5)).toBe(details[2]);
    expect(detailFor(whole, 0.01, 10)).toBe(details[2]);
    expect(detailFor(whole, 0.01, (details[0]?.points ?? 0) + 1)).toBe(details[0]);
  });
});
