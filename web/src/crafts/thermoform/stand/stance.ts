// SPDX-License-Identifier: GPL-3.0-or-later
// Which way up a model stands and how far it is turned: rotations from the model's axes to the machine's, and the parameters `up` and `turn_deg` that say the same.

import type { Rotation, Vector } from '../../../shared/geometry/rotation';
import {
  about,
  after,
  cross,
  dot,
  ofRows,
  row,
  times,
  turned,
  turnedBack,
  unit,
} from '../../../shared/geometry/rotation';

export interface Stance {
  readonly up: Vector;
  readonly turn_deg: number;
}

/** The smallest rotation from one unit vector to another; where they are opposite, about `axisOfHalfTurn`. */
function shortest(from: Vector, to: Vector, axisOfHalfTurn: Vector): Rotation {
  const [normal, cosine] = [cross(from, to), dot(from, to)];
  const axis = unit(normal);
  if (axis === null || Math.hypot(...normal) < 1e-9) return about(axisOfHalfTurn, cosine > 0 ? 0 : 180);
  return about(axis, (Math.atan2(Math.hypot(...normal), cosine) * 180) / Math.PI);
}

/** As the core stands a model up: `up` becomes z, and the front (z, or -y where z is up) comes to face the maker.
 *  Null for an `up` without length. */
export function standing(up: Vector): Rotation | null {
  const z = unit(up);
  if (z === null) return null;
  const front: Vector = Math.abs(z[2]) < 0.9 ? [0, 0, 1] : [0, z[2] > 0 ? -1 : 1, 0];
  const along = dot(front, z);
  const level = unit([front[0] - along * z[0], front[1] - along * z[1], front[2] - along * z[2]]);
  return level && ofRows(cross(z, level), times(level, -1), z);
}

export function rotationOf({ up, turn_deg }: Stance): Rotation | null {
  const upright = standing(up);
  return upright && after(about([0, 0, 1], turn_deg), upright);
}

const decimals = (value: number, count: number): number => Number(value.toFixed(count)) || 0;

/** The parameters of a rotation, with a turn from -180 to 180 degrees, to a hundredth. `up` is as exact as numbers are: a
 *  face that was put on the plate lies flat. */
export function stanceOf(r: Rotation): Stance {
  const up = row(r, 2).map((value) => decimals(value, 12)) as unknown as Vector;
  // What turns the front that the core chooses to where it is.
  const upright = standing(up) as Rotation;
  const x = turned(r, row(upright, 0));
  return { up, turn_deg: decimals((Math.atan2(x[1], x[0]) * 180) / Math.PI, 2) };
}

/** -180 to 180 degrees. */
export const withinHalfTurn = (angle_deg: number): number => angle_deg - 360 * Math.round(angle_deg / 360);

const backwards: Vector = [0, 1, 0];
const down: Vector = [0, 0, -1];

/** Puts a side on the plate by the smallest rotation; `outward` is the side's normal in the model's axes. */
export function placedOn(r: Rotation, outward: Vector): Rotation {
  const normal = unit(outward);
  if (normal === null) return r;
  // A model that is put on its top keeps its front in front.
  return after(shortest(turned(r, normal), down, backwards), r);
}

/** Sides of a model as it stands, seen from before the machine. */
export const sides = {
  left: [-1, 0, 0],
  right: [1, 0, 0],
  front: [0, -1, 0],
  back: [0, 1, 0],
  top: [0, 0, 1],
} as const;
export type Side = keyof typeof sides;

/** Lays the model on one of its sides: of the directions of its own axes the one that faces most to that side. */
export function laidOn(r: Rotation, side: Side): Rotation {
  const upwards = turnedBack(r, [0, 0, 1]);
  const wanted = turnedBack(r, sides[side]);
  const upAxis = longest(upwards, null);
  const axis = side === 'top' ? upAxis : longest(wanted, upAxis);
  const outward = [0, 0, 0] as [number, number, number];
  outward[axis] = Math.sign(wanted[axis]) || 1;
  return placedOn(r, outward);
}

/** Along which axis a vector reaches furthest, not counting one of them. */
function longest(v: Vector, except: number | null): 0 | 1 | 2 {
  const axes = ([0, 1, 2] as const).filter((axis) => axis !== except);
  return axes.reduce((best, axis) => (Math.abs(v[axis]) > Math.abs(v[best]) ? axis : best));
}
