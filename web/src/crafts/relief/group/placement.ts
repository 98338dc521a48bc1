// SPDX-License-Identifier: GPL-3.0-or-later
// Where models of a group are, as the operation `combine` places them: turned about x, y and z, in this order.
import type { PlacedModel } from '../../../shared/session/craft_document';

export type Triple = readonly [number, number, number];
/** Rows of a rotation. */
export type Matrix = readonly [Triple, Triple, Triple];

const degree = Math.PI / 180;

const dot = (a: Triple, b: Triple): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const along = (p: Triple, a: Triple, by: number): Triple => [
  p[0] + by * a[0],
  p[1] + by * a[1],
  p[2] + by * a[2],
];
const cross = (a: Triple, b: Triple): Triple => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
const unit = (a: Triple): Triple => {
  const length = Math.hypot(...a) || 1;
  return [a[0] / length, a[1] / length, a[2] / length];
};
const column = (m: Matrix, k: 0 | 1 | 2): Triple => [m[0][k], m[1][k], m[2][k]];
const product = (a: Matrix, b: Matrix): Matrix => {
  const row = (r: Triple): Triple => [dot(r, column(b, 0)), dot(r, column(b, 1)), dot(r, column(b, 2))];
  return [row(a[0]), row(a[1]), row(a[2])];
};

/** Right, up and away from the viewer. */
export interface ViewAxes {
  readonly right: Triple;
  readonly up: Triple;
  readonly away: Triple;
}

export function viewAxes(direction: Triple, up: Triple): ViewAxes {
  const away = unit(direction);
  const right = unit(cross(away, up));
  return { right, up: cross(right, away), away };
}

/** Counter-clockwise seen from the axis' tip. */
export function about(axis: Triple, angle_deg: number): Matrix {
  const [x, y, z] = unit(axis);
  const [c, s] = [Math.cos(angle_deg * degree), Math.sin(angle_deg * degree)];
  const t = 1 - c;
  return [
    [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
    [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
    [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
  ];
}

export const rotationOf = ([x, y, z]: Triple): Matrix =>
  product(about([0, 0, 1], z), product(about([0, 1, 0], y), about([1, 0, 0], x)));

const tidy = (angle: number): number => Number((angle / degree).toFixed(4)) + 0;

/** The angles of a rotation; where they are not unique, none about z. */
export function anglesOf(m: Matrix): Triple {
  const sine = Math.min(1, Math.max(-1, -m[2][0]));
  const y = Math.asin(sine);
  if (Math.abs(sine) > 1 - 1e-12) return [tidy(Math.atan2(sine * m[0][1], m[1][1])), tidy(y), 0];
  return [tidy(Math.atan2(m[2][1], m[2][2])), tidy(y), tidy(Math.atan2(m[1][0], m[0][0]))];
}

/** Turned further about an axis of the scene. */
export const turnedBy = (turn_deg: Triple, axis: Triple, angle_deg: number): Triple =>
  anglesOf(product(about(axis, angle_deg), rotationOf(turn_deg)));

/** Vertices of a model that stands as `from` says, as they are when it stands as `to` says. */
export function movedVertices(positions: Float32Array, from: PlacedModel, to: PlacedModel): Float32Array {
  const back = rotationOf(from.turn_deg);
  const own: Matrix = [column(back, 0), column(back, 1), column(back, 2)]; // its inverse
  const turn = product(rotationOf(to.turn_deg), own);
  const factor = to.size_mm / from.size_mm;
  const moved = new Float32Array(positions.length);
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; i += 3) {
    const p: Triple = [
      (positions[i] ?? 0) - from.at_mm[0],
      (positions[i + 1] ?? 0) - from.at_mm[1],
      (positions[i + 2] ?? 0) - from.at_mm[2],
    ];
    for (const k of [0, 1, 2] as const) {
      const value = factor * dot(turn[k], p);
      moved[i + k] = value;
      low[k] = Math.min(low[k] ?? 0, value);
      high[k] = Math.max(high[k] ?? 0, value);
    }
  }
  // The middle of its box as it stands now comes to its place.
  const shift = [0, 1, 2].map((k) => (to.at_mm[k] ?? 0) - ((low[k] ?? 0) + (high[k] ?? 0)) / 2);
  for (let i = 0; i < moved.length; ++i) moved[i] = (moved[i] ?? 0) + (shift[i % 3] ?? 0);
  return moved;
}

/** A box by its middle and its sizes along x, y and z. */
export interface Box {
  readonly at_mm: Triple;
  readonly size_mm: Triple;
}

/** How far boxes reach along an axis. */
export function reach(boxes: readonly Box[], axis: Triple): { readonly low: number; readonly high: number } {
  const half = ({ size_mm }: Box) =>
    (Math.abs(axis[0]) * size_mm[0] + Math.abs(axis[1]) * size_mm[1] + Math.abs(axis[2]) * size_mm[2]) / 2;
  return {
    low: Math.min(...boxes.map((box) => dot(box.at_mm, axis) - half(box))),
    high: Math.max(...boxes.map((box) => dot(box.at_mm, axis) + half(box))),
  };
}

const gap_mm = 10;

/** The place of a new box: right of all others as the viewer sees them, on the same ground, in the same depth. */
export function placeBeside(boxes: readonly Box[], size_mm: Triple, { right, up, away }: ViewAxes): Triple {
  const new_box = [{ at_mm: [0, 0, 0] as Triple, size_mm }];
  const depth = reach(boxes, away);
  let at: Triple = [0, 0, 0];
  at = along(at, right, reach(boxes, right).high + gap_mm - reach(new_box, right).low);
  at = along(at, up, reach(boxes, up).low - reach(new_box, up).low);
  at = along(at, away, (depth.low + depth.high) / 2);
  return at.map((value) => Number(value.toFixed(3)) + 0) as unknown as Triple;
}
