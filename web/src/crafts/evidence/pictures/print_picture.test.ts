// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { frameOf } from './frame';
import { colourAt, enlargementOf, patternOf, printOf } from './print_picture';
import type { Residuals } from './residuals';
import { extentOf, movedBy, movesOf } from './residuals';
import { triangulate } from './sheet_surface';

/** A tent over 200 x 200 mm, 40 mm high in the middle; the extended simulation has it `aside` to the right. */
function tent(aside: number, stretch = 1): Residuals {
  const sheet: number[] = [];
  const base: number[] = [];
  const extended: number[] = [];
  for (let i = -10; i <= 10; ++i)
    for (let j = -10; j <= 10; ++j) {
      const [x, y] = [10 * i, 10 * j];
      const z = 40 - 0.4 * Math.max(Math.abs(x), Math.abs(y));
      sheet.push(x, y);
      base.push(x, y, z);
      extended.push(stretch * x + aside, y, z);
    }
  const measured = Float64Array.from(base);
  return {
    count: sheet.length / 2,
    sheet: Float64Array.from(sheet),
    measured,
    base: Float64Array.from(base),
    extended: Float64Array.from(extended),
  };
}

describe('a print before and after', () => {
  it('has bands and squares in round lengths', () => {
    const pattern = patternOf(tent(0));
    expect(pattern).toEqual({ band_mm: 5, square_mm: 20 });
    expect(colourAt(20.1, 7, 3, pattern)).toEqual(colourAt(7, -40.2, 13, pattern));
    expect(colourAt(7, 7, 3, pattern)).not.toEqual(colourAt(7, 7, 8, pattern));
    expect(colourAt(7, 7, 3, pattern)).toEqual(colourAt(7, 7, 13, pattern));
  });

  it('puts each place of the pattern where the simulation takes it', () => {
    const residuals = tent(8);
    const frame = frameOf(extentOf(residuals), 600);
    const triangles = triangulate(residuals);
    const pattern = patternOf(residuals);
    const [before, after] = [0, 1].map((shift) => printOf(residuals, shift, triangles, frame, pattern));
    const at = (pixels: Uint8ClampedArray | undefined, x: number, y: number) => {
      const column = Math.round((x - frame.left_mm) * frame.pixelsPerMm - 0.5);
      const row = Math.round((frame.top_mm - y) * frame.pixelsPerMm - 0.5);
      return [
        ...(pixels?.slice(4 * (row * frame.widthPx + column), 4 * (row * frame.widthPx + column) + 3) ?? []),
      ];
    };
    const line = [...colourAt(20, 10, 3, pattern)];
    // The line at x = 20 of the object is printed at 20, or 8 to the left where everything lands 8 to the right.
    expect(at(before, 20, 30)).toEqual(line);
    expect(at(before, 12, 30)).not.toEqual(line);
    expect(at(after, 12, 30)).toEqual(line);
    expect(at(after, 20, 30)).not.toEqual(line);
    expect(before?.[3]).toBe(0); // the margin is clear
    const twice = printOf(residuals, 2, triangles, frame, pattern);
    expect(at(twice, 4, 30)).toEqual(line);
  });

  it('enlarges what is too small to be seen, by a round number', () => {
    expect(enlargementOf(tent(8))).toBe(1);
    expect(enlargementOf(tent(0.5))).toBe(20);
    expect(enlargementOf(tent(30))).toBe(1);
    expect(enlargementOf(tent(0))).toBe(50);
  });

  it('tells how far features move', () => {
    expect(movedBy(tent(8))).toEqual({ mean_mm: 8, largest_mm: 8 });
    expect(Math.max(...movesOf(tent(0, 1.1)))).toBeCloseTo(10, 9);
    expect(movedBy({ ...tent(8), extended: null })).toBeNull();
  });
});
