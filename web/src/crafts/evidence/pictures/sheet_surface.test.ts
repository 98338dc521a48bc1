// SPDX-License-Identifier: GPL-3.0-or-later
import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import type { Frame } from './frame';
import { rasterise, triangulate } from './sheet_surface';

const gridOf = (side: number, without: (x: number, y: number) => boolean = () => false): Float64Array =>
  Float64Array.from(
    Array.from({ length: side * side }, (_, i) => [i % side, Math.floor(i / side)] as const)
      .filter(([x, y]) => !without(x, y))
      .flat(),
  );

function areaOf(sheet: Float64Array, triangles: Uint32Array): number {
  let sum = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => {
      const i = triangles[t + k] ?? 0;
      return [sheet[2 * i] ?? 0, sheet[2 * i + 1] ?? 0] as const;
    });
    if (!a || !b || !c) continue;
    const area = ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])) / 2;
    expect(area).toBeGreaterThan(0);
    sum += area;
  }
  return sum;
}

const frame: Frame = { widthPx: 60, heightPx: 60, pixelsPerMm: 10, left_mm: -0.5, top_mm: 5.5 };

describe('the surface between measured points', () => {
  it('covers a grid once, looking up', () => {
    const sheet = gridOf(8);
    expect(areaOf(sheet, triangulate({ sheet, count: 64 }))).toBeCloseTo(49, 9);
  });

  it('leaves gaps of the data open', () => {
    const sheet = gridOf(21, (x, y) => Math.hypot(x - 10, y - 10) < 7);
    const area = areaOf(sheet, triangulate({ sheet, count: sheet.length / 2 }));
    expect(area).toBeLessThan(400 - 100);
    expect(area).toBeGreaterThan(400 - Math.PI * 64);
  });

  it('is nothing for less than a triangle', () => {
    expect(triangulate({ sheet: Float64Array.of(0, 0, 1, 1), count: 2 })).toHaveLength(0);
  });

  it('keeps linear values linear and stays empty outside', () => {
    const slope = fc.double({ min: -5, max: 5, noNaN: true });
    fc.assert(
      fc.property(slope, slope, slope, (a, b, c) => {
        const sheet = gridOf(6);
        const values = Float64Array.from(
          { length: 36 },
          (_, i) => a * (sheet[2 * i] ?? 0) + b * (sheet[2 * i + 1] ?? 0) + c,
        );
        const raster = rasterise(sheet, triangulate({ sheet, count: 36 }), values, frame);
        expect(raster[0]).toBeNaN();
        for (const [column, row] of [
          [10, 50],
          [30, 30],
          [48, 12],
        ] as const) {
          const [x, y] = [-0.5 + (column + 0.5) / 10, 5.5 - (row + 0.5) / 10];
          expect(raster[row * 60 + column]).toBeCloseTo(a * x + b * y + c, 4);
        }
      }),
      { numRuns: 30, seed: 7 },
    );
  });
});
