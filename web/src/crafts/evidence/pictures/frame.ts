// SPDX-License-Identifier: GPL-3.0-or-later
// The flat sheet as a picture: its first row is the back, as one looks at the sheet from above.
import type { Extent } from './residuals';

export interface Frame {
  readonly widthPx: number;
  readonly heightPx: number;
  readonly pixelsPerMm: number;
  /** Upper left corner, mm on the sheet. */
  readonly left_mm: number;
  readonly top_mm: number;
}

/** Of what was measured, with a narrow margin; the page scales the picture. */
export function frameOf({ low, high }: Extent, widthPx = 300): Frame {
  const margin = 0.03 * Math.max(high[0] - low[0], high[1] - low[1], 1);
  const width_mm = high[0] - low[0] + 2 * margin;
  const pixelsPerMm = widthPx / width_mm;
  const heightPx = Math.round((high[1] - low[1] + 2 * margin) * pixelsPerMm);
  return { widthPx, heightPx, pixelsPerMm, left_mm: low[0] - margin, top_mm: high[1] + margin };
}

export const placeOn = ({ left_mm, top_mm, pixelsPerMm }: Frame, x: number, y: number): [number, number] => [
  (x - left_mm) * pixelsPerMm,
  (top_mm - y) * pixelsPerMm,
];
