// SPDX-License-Identifier: GPL-3.0-or-later
// How an eye sees the forest: by central projection onto the plane through what it looks at, square to its line of
// sight. There the model's picture is as wide as the viewpoint says.
import type { Place, Place3, Viewpoint } from '../scene';

export interface Seen {
  /** On the plane, from what is looked at: right and up. */
  readonly x_mm: number;
  readonly y_mm: number;
}

type Vector = readonly [number, number, number];
const dot = (a: Vector, b: Vector) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const scaled = (a: Vector, by: number): Vector => [a[0] * by, a[1] * by, a[2] * by];
const cross = (a: Vector, b: Vector): Vector => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
const unit = (a: Vector): Vector => scaled(a, 1 / Math.hypot(...a));

/** Of the distance of what is looked at: what is nearer to the eye is not drawn. */
const nearest_share = 0.02;

export class EyeCamera {
  readonly eye_mm: Place3;
  readonly #distance_mm: number;
  readonly #look: Vector;
  readonly #right: Vector;
  readonly #up: Vector;
  /** In the floor plan, unit length. */
  readonly #forward: Place;

  /** The eye must not be straight above or below what it looks at; the core refuses that. */
  constructor({ eye_mm, look_at_mm }: Viewpoint) {
    this.eye_mm = eye_mm;
    const to: Vector = [look_at_mm[0] - eye_mm[0], look_at_mm[1] - eye_mm[1], look_at_mm[2] - eye_mm[2]];
    this.#distance_mm = Math.hypot(...to);
    this.#look = unit(to);
    this.#right = unit(cross(this.#look, [0, 0, 1]));
    this.#up = cross(this.#right, this.#look);
    const level = Math.hypot(to[0], to[1]);
    this.#forward = [to[0] / level, to[1] / level];
  }

  get nearest_mm(): number {
    return nearest_share * this.#distance_mm;
  }

  /** Of a place that lies ahead. */
  seen([x, y]: Place, z: number): Seen {
    const from: Vector = [x - this.eye_mm[0], y - this.eye_mm[1], z - this.eye_mm[2]];
    const share = this.#distance_mm / dot(from, this.#look);
    return { x_mm: share * dot(from, this.#right), y_mm: share * dot(from, this.#up) };
  }

  /** In the floor plan, along the line of sight. */
  ahead_mm([x, y]: Place): number {
    return this.#forward[0] * (x - this.eye_mm[0]) + this.#forward[1] * (y - this.eye_mm[1]);
  }

  /** In the floor plan, to the right of the line of sight. */
  aside_mm([x, y]: Place): number {
    return this.#forward[1] * (x - this.eye_mm[0]) - this.#forward[0] * (y - this.eye_mm[1]);
  }
}
