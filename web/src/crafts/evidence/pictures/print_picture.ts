// SPDX-License-Identifier: GPL-3.0-or-later
// What a print of a regular pattern looks like on the flat sheet, so that it is regular on the formed object: each place of
// the sheet has the colour of the place in space that the simulation takes it to. Two simulations make two prints.
import type { Frame } from './frame';
import type { Residuals } from './residuals';
import { heightsOf, movesOf, niceUp, percentile, scaleFor } from './residuals';
import { rasterise } from './sheet_surface';

export interface Pattern {
  /** Height of a band, and side of the squares seen from above, mm on the object. */
  readonly band_mm: number;
  readonly square_mm: number;
}

/** With fewer points the surface between them says more about the points than about the sheet. */
export const minPrintPoints = 100;
const bands = 8;
const squares = 10;
/** Half the width of a line, as a share of a square. */
const lineShare = 0.03;
const maxEnlargement = 50;
type Colour = readonly [number, number, number];
const paper: Colour = [250, 248, 244];
const tint: Colour = [226, 190, 140];
const ink: Colour = [60, 52, 44];

/** About eight bands over the object's height and ten squares across, in round lengths; the same for both prints. */
export function patternOf({ measured, sheet }: Residuals): Pattern {
  const heights = heightsOf(measured);
  const rise = percentile(heights, 0.995) - percentile(heights, 0.02);
  const across = percentile(sheet, 0.99) - percentile(sheet, 0.01);
  return { band_mm: niceUp(Math.max(rise, 1) / bands), square_mm: niceUp(Math.max(across, 1) / squares) };
}

const offLine = (value: number, step: number): number => Math.abs(value - step * Math.round(value / step));

/** Of a place in space: bands of height, and squares as seen from above. */
export function colourAt(x: number, y: number, z: number, { band_mm, square_mm }: Pattern): Colour {
  if (Math.min(offLine(x, square_mm), offLine(y, square_mm)) < lineShare * square_mm) return ink;
  return Math.floor(z / band_mm) % 2 === 0 ? paper : tint;
}

/** By how much the shift between both prints is drawn larger, so that it is seen: 1 where it is large enough. */
export const enlargementOf = (residuals: Residuals): number =>
  Math.min(maxEnlargement, Math.max(1, scaleFor(movesOf(residuals), 0.5 * patternOf(residuals).square_mm)));

/** Red, green, blue and alpha of each pixel; clear where nothing was measured. `shift`: 0 for the print of the calibrated
 *  simulation, 1 for that with the cause, more to enlarge what it changes. */
export function printOf(
  residuals: Residuals,
  shift: number,
  triangles: Uint32Array,
  frame: Frame,
  pattern: Pattern,
): Uint8ClampedArray<ArrayBuffer> {
  const { base, extended } = residuals;
  const place = (i: number): number =>
    (base[i] ?? 0) + shift * ((extended?.[i] ?? base[i] ?? 0) - (base[i] ?? 0));
  const [xs, ys, zs] = [0, 1, 2].map((k) =>
    rasterise(
      residuals.sheet,
      triangles,
      Float64Array.from({ length: residuals.count }, (_, i) => place(3 * i + k)),
      frame,
    ),
  );
  const pixels = new Uint8ClampedArray(4 * frame.widthPx * frame.heightPx);
  for (let i = 0; i < frame.widthPx * frame.heightPx; ++i) {
    const [x = NaN, y = NaN, z = NaN] = [xs?.[i], ys?.[i], zs?.[i]];
    if (!Number.isNaN(z)) pixels.set([...colourAt(x, y, z, pattern), 255], 4 * i);
  }
  return pixels;
}
