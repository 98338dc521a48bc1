// SPDX-License-Identifier: GPL-3.0-or-later
// Where models of a group are, as the operation `combine` places them: turned about x, y and z, in this order.
import type { PlacedModel } from '../../../shared/session/craft_document';

import type { Rotation, Vector } from '../../../shared/geometry/rotation';
import { about, after, cross, dot, inverse, turned, unit } from '../../../shared/geometry/rotation';

const degree = Math.PI / 180;

export const along = (p: Vector, a: Vector, by: number): Vector => [
  p[0] + by * a[0],
  p[1] + by * a[1],
  p[2] + by * a[2],
];

/** Right, up and away from the viewer. */
export interface ViewAxes {
  readonly right: Vector;
  readonly up: Vector;
  readonly away: Vector;
}

export function viewAxes(direction: Vector, up: Vector): ViewAxes {
  const away = unit(direction) ?? [0, 0, -1];
  const right = unit(cross(away, up)) ?? [1, 0, 0];
  return { right, up: cross(right, away), away };
}

export const rotationOf = ([x, y, z]: Vector): Rotation =>
  after(about([0, 0, 1], z), after(about([0, 1, 0], y), about([1, 0, 0], x)));

const tidy = (angle: number): number => Number((angle / degree).toFixed(4)) + 0;

/** The angles of a rotation; where they are not unique, none about z. */
export function anglesOf([xx, xy, , yx, yy, , zx, zy, zz]: Rotation): Vector {
  const sine = Math.min(1, Math.max(-1, -zx));
  const y = Math.asin(sine);
  if (Math.abs(sine) > 1 - 1e-12) return [tidy(Math.atan2(sine * xy, yy)), tidy(y), 0];
  return [tidy(Math.atan2(zy, zz)), tidy(y), tidy(Math.atan2(yx, xx))];
}

/** Turned further about an axis of the scene. */
export const turnedBy = (turn_deg: Vector, axis: Vector, angle_deg: number): Vector =>
  anglesOf(after(about(axis, angle_deg), rotationOf(turn_deg)));

/** Vertices of a model that stands as `from` says, as they are when it stands as `to` says. */
export function movedVertices(positions: Float32Array, from: PlacedModel, to: PlacedModel): Float32Array {
  const turn = after(rotationOf(to.turn_deg), inverse(rotationOf(from.turn_deg)));
  const factor = to.size_mm / from.size_mm;
  const moved = new Float32Array(positions.length);
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; i += 3) {
    const p: Vector = [
      (positions[i] ?? 0) - from.at_mm[0],
      (positions[i + 1] ?? 0) - from.at_mm[1],
      (positions[i + 2] ?? 0) - from.at_mm[2],
    ];
    for (const [k, along] of turned(turn, p).entries()) {
      const value = factor * along;
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
  readonly at_mm: Vector;
  readonly size_mm: Vector;
}

/** How far boxes reach along an axis. */
export function reach(boxes: readonly Box[], axis: Vector): { readonly low: number; readonly high: number } {
  const half = ({ size_mm }: Box) =>
    (Math.abs(axis[0]) * size_mm[0] + Math.abs(axis[1]) * size_mm[1] + Math.abs(axis[2]) * size_mm[2]) / 2;
  return {
    low: Math.min(...boxes.map((box) => dot(box.at_mm, axis) - half(box))),
    high: Math.max(...boxes.map((box) => dot(box.at_mm, axis) + half(box))),
  };
}

const gap_mm = 10;

/** The place of a new box: right of all others as the viewer sees them, on the same ground, in the same depth. */
export function placeBeside(boxes: readonly Box[], size_mm: Vector, { right, up, away }: ViewAxes): Vector {
  const new_box = [{ at_mm: [0, 0, 0] as Vector, size_mm }];
  const depth = reach(boxes, away);
  let at: Vector = [0, 0, 0];
  at = along(at, right, reach(boxes, right).high + gap_mm - reach(new_box, right).low);
  at = along(at, up, reach(boxes, up).low - reach(new_box, up).low);
  at = along(at, away, (depth.low + depth.high) / 2);
  return at.map((value) => Number(value.toFixed(3)) + 0) as unknown as Vector;
}
