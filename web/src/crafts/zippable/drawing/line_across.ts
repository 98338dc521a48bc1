// SPDX-License-Identifier: GPL-3.0-or-later
/* eslint-disable @typescript-eslint/no-non-null-assertion -- indices stay within the arrays' own lengths */
// A straight line on the screen as a knife: the plane through the eye and the line, and which of the loops it cuts is meant.
import type { Place3 } from './drawn_parts';
import type { Chain, Plane } from './plane_section';

/** A line of sight through a point of the screen. */
export interface Sight {
  readonly origin: Place3;
  /** Of length 1. */
  readonly direction: Place3;
}

const cross = (a: Place3, b: Place3): Place3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
const dot = (a: Place3, b: Place3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const between = (a: Place3, b: Place3): Place3 => [b[0] - a[0], b[1] - a[1], b[2] - a[2]];

function unit(a: Place3): Place3 | null {
  const length = Math.hypot(...a);
  return length > 0 && Number.isFinite(length) ? [a[0] / length, a[1] / length, a[2] / length] : null;
}

/** With both lines of sight in it; null where they are one. */
export function planeThrough(first: Sight, last: Sight): Plane | null {
  // Parallel lines of sight differ in their origins, those from one eye in their directions; both sums point to the same side.
  const byOrigin = cross(first.direction, between(first.origin, last.origin));
  const byDirection = cross(first.direction, last.direction);
  const normal = unit([
    byOrigin[0] + byDirection[0],
    byOrigin[1] + byDirection[1],
    byOrigin[2] + byDirection[2],
  ]);
  return normal && { normal, offset: dot(normal, first.origin) };
}

/** A chain of a section, and where it is seen first. */
export interface Seen {
  readonly chain: Chain;
  /** Between which of its points, as 3.25 is a quarter of the way from the fourth to the next. */
  readonly at: number;
}

/** What the lines of sight, which lie in the plane, meet first; null for those that pass the model. */
function firstMet(chains: readonly Chain[], plane: Plane, sights: readonly Sight[]): (Seen | null)[] {
  const right = unit(sights[0]?.direction ?? [0, 0, 0]);
  if (right === null) return sights.map(() => null);
  const up = cross(plane.normal, right);
  const flat = (at: Place3): readonly [number, number] => [dot(at, right), dot(at, up)];
  const outlines = chains.map(({ points, closed }) => {
    const count = points.length / 3;
    const outline = new Float64Array(2 * (closed ? count + 1 : count));
    for (let i = 0; 2 * i < outline.length; ++i) {
      const from = 3 * (i % count);
      outline.set(flat([points[from]!, points[from + 1]!, points[from + 2]!]), 2 * i);
    }
    return outline;
  });
  return sights.map(({ origin, direction }) => {
    const [[x, y], [dx, dy]] = [flat(origin), flat(direction)];
    let nearest = Infinity;
    let seen: Seen | null = null;
    outlines.forEach((outline, number) => {
      let [wayBefore, sideBefore] = [0, 0];
      for (let i = 0; 2 * i < outline.length; ++i) {
        const [px, py] = [outline[2 * i]! - x, outline[2 * i + 1]! - y];
        const [way, side] = [dx * px + dy * py, dx * py - dy * px];
        if (i > 0 && side >= 0 !== sideBefore >= 0) {
          const share = sideBefore / (sideBefore - side);
          const met = wayBefore + share * (way - wayBefore);
          if (met > 0 && met < nearest) {
            nearest = met;
            seen = { chain: chains[number]!, at: i - 1 + share };
          }
        }
        [wayBefore, sideBefore] = [way, side];
      }
    });
    return seen;
  });
}

/** What is seen first in the middle of those lines of sight that meet the model; null where none does. */
export function chainAcross(chains: readonly Chain[], plane: Plane, sights: readonly Sight[]): Seen | null {
  const met = firstMet(chains, plane, sights).filter((seen) => seen !== null);
  return met[Math.floor(met.length / 2)] ?? null;
}
