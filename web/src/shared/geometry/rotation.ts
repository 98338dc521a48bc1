// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors and rotations, 3 x 3 row by row.

export type Vector = readonly [number, number, number];
export type Rotation = readonly [number, number, number, number, number, number, number, number, number];

export const dot = (a: Vector, b: Vector): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Vector, b: Vector): Vector => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const times = (a: Vector, factor: number): Vector => [factor * a[0], factor * a[1], factor * a[2]];

/** Null for a vector without length. */
export function unit(a: Vector): Vector | null {
  const length = Math.hypot(...a);
  return length > 1e-12 && Number.isFinite(length) ? times(a, 1 / length) : null;
}

export const row = (r: Rotation, k: 0 | 1 | 2): Vector =>
  [r.slice(0, 3), r.slice(3, 6), r.slice(6, 9)][k] as unknown as Vector;
const column = (r: Rotation, k: 0 | 1 | 2): Vector => [r[k], r[3 + k], r[6 + k]] as Vector;
export const ofRows = (x: Vector, y: Vector, z: Vector): Rotation => [...x, ...y, ...z];

export const turned = (r: Rotation, v: Vector): Vector => [
  dot(row(r, 0), v),
  dot(row(r, 1), v),
  dot(row(r, 2), v),
];
/** By the inverse of the rotation. */
export const turnedBack = (r: Rotation, v: Vector): Vector => [
  dot(column(r, 0), v),
  dot(column(r, 1), v),
  dot(column(r, 2), v),
];

/** First `b`, then `a`. */
export function after(a: Rotation, b: Rotation): Rotation {
  const columns = ([0, 1, 2] as const).map((k) => turned(a, column(b, k))) as [Vector, Vector, Vector];
  const [x, y, z] = columns;
  return [x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]];
}

/** About an axis of length 1, counter-clockwise seen from its tip. */
export function about([x, y, z]: Vector, angle_deg: number): Rotation {
  const angle = (angle_deg * Math.PI) / 180;
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const t = 1 - c;
  return [
    c + x * x * t,
    x * y * t - z * s,
    x * z * t + y * s,
    y * x * t + z * s,
    c + y * y * t,
    y * z * t - x * s,
    z * x * t - y * s,
    z * y * t + x * s,
    c + z * z * t,
  ];
}

/** The inverse of a rotation. */
export const inverse = (r: Rotation): Rotation => ofRows(column(r, 0), column(r, 1), column(r, 2));
