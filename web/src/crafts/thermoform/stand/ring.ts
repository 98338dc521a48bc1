// SPDX-License-Identifier: GPL-3.0-or-later
// The rings that a model is turned by: about the vertical axis, to the sides, and to front and back.
import type { Box, Ray } from '../placement';
import type { Vector } from '../../../shared/geometry/rotation';

export type Handle = 'turn' | 'sideways' | 'forwards';
export const handles: readonly Handle[] = ['turn', 'sideways', 'forwards'];

/** A circle about `axis`; angles grow counter-clockwise seen from the axis' tip, from `zero` towards `quarter`. */
export interface Ring {
  readonly centre: Vector;
  readonly axis: Vector;
  readonly zero: Vector;
  readonly quarter: Vector;
  readonly radius_mm: number;
  /** Where its handle is while nobody holds it. */
  readonly rest_deg: number;
}

const clear_mm = 10;
const min_radius_mm = 30;

/** Around a model that stands in `box`. */
export function ringAround({ low, high }: Box, handle: Handle): Ring {
  const half = [0, 1, 2].map((k) => ((high[k] ?? 0) - (low[k] ?? 0)) / 2) as unknown as Vector;
  const middle: Vector = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2];
  const radius = (a: number, b: number) => Math.max(min_radius_mm, Math.hypot(a, b) + clear_mm);
  if (handle === 'turn')
    return {
      centre: [middle[0], middle[1], 0],
      axis: [0, 0, 1],
      zero: [1, 0, 0],
      quarter: [0, 1, 0],
      radius_mm: radius(half[0], half[1]),
      rest_deg: -35,
    };
  // From straight up: to the right, or towards the maker.
  if (handle === 'sideways')
    return {
      centre: middle,
      axis: [0, 1, 0],
      zero: [0, 0, 1],
      quarter: [1, 0, 0],
      radius_mm: radius(half[0], half[2]),
      rest_deg: 50,
    };
  return {
    centre: middle,
    axis: [1, 0, 0],
    zero: [0, 0, 1],
    quarter: [0, -1, 0],
    radius_mm: radius(half[1], half[2]),
    rest_deg: 0,
  };
}

const dot = (a: Vector, b: Vector): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

export function pointOn(ring: Ring, angle_deg: number, radius_mm = ring.radius_mm): Vector {
  const angle = (angle_deg * Math.PI) / 180;
  const [c, s] = [radius_mm * Math.cos(angle), radius_mm * Math.sin(angle)];
  const at = (k: 0 | 1 | 2) => ring.centre[k] + c * ring.zero[k] + s * ring.quarter[k];
  return [at(0), at(1), at(2)];
}

/** Rays that run more along the ring's plane than this give no reliable angle. */
const minSlope = 0.35;

/** The angle under which a ray of sight meets the ring's plane; null where it runs along it. */
export function angleSeen(ring: Ring, { originMm, direction }: Ray): number | null {
  const slope = dot(direction, ring.axis) / Math.hypot(...direction);
  if (Math.abs(slope) < minSlope) return null;
  const from: Vector = [
    originMm[0] - ring.centre[0],
    originMm[1] - ring.centre[1],
    originMm[2] - ring.centre[2],
  ];
  const t = -dot(from, ring.axis) / dot(direction, ring.axis);
  const p: Vector = [from[0] + t * direction[0], from[1] + t * direction[1], from[2] + t * direction[2]];
  return (Math.atan2(dot(p, ring.quarter), dot(p, ring.zero)) * 180) / Math.PI;
}

const steps = 96;

/** The ring as x, y, z of its points. */
export const circle = (ring: Ring): Float32Array =>
  Float32Array.from(Array.from({ length: steps }, (_, i) => pointOn(ring, (360 * i) / steps)).flat());

/** Short lines at every `step_deg`, two points each. */
export const ticks = (ring: Ring, step_deg: number): Float32Array =>
  Float32Array.from(
    Array.from({ length: Math.round(360 / step_deg) }, (_, i) => [
      ...pointOn(ring, i * step_deg + ring.rest_deg),
      ...pointOn(ring, i * step_deg + ring.rest_deg, 1.05 * ring.radius_mm),
    ]).flat(),
  );
