// SPDX-License-Identifier: GPL-3.0-or-later
// Between the bed (lower left 0, y up) as it is drawn and the coordinates that the controller counts in.

export type Origin = 'lower_left' | 'upper_left' | 'centre';
export type Bounds = readonly [number, number, number, number];
type Size = readonly [number, number];

export const asOrigin = (value: unknown): Origin =>
  value === 'upper_left' || value === 'centre' ? value : 'lower_left';

/** Upper left counts y downwards. */
export function bedOfWork([x, y]: Size, origin: Origin, [bed_x, bed_y]: Size): Size {
  if (origin === 'centre') return [x + bed_x / 2, y + bed_y / 2];
  return origin === 'upper_left' ? [x, bed_y - y] : [x, y];
}

export function workOfBed([x, y]: Size, origin: Origin, [bed_x, bed_y]: Size): Size {
  if (origin === 'centre') return [x - bed_x / 2, y - bed_y / 2];
  return origin === 'upper_left' ? [x, bed_y - y] : [x, y];
}

export function workBoundsOfBed([x0, y0, x1, y1]: Bounds, origin: Origin, bed: Size): Bounds {
  const [a, b] = [workOfBed([x0, y0], origin, bed), workOfBed([x1, y1], origin, bed)];
  return [Math.min(a[0], b[0]), Math.min(a[1], b[1]), Math.max(a[0], b[0]), Math.max(a[1], b[1])];
}
