// SPDX-License-Identifier: GPL-3.0-or-later
/* eslint-disable @typescript-eslint/no-non-null-assertion -- indices stay within the arrays' own lengths */
// A border's points along a plane's loop: as few as keep the way between them near the plane, for they are to be moved by hand.
import type { Place3 } from './drawn_parts';
import type { Seen } from './line_across';
import type { Plane } from './plane_section';
import { distanceTo } from './plane_section';

/** Along which the shortest ways between points run. */
export interface Ways {
  through(points: readonly Place3[], closed: boolean): Float32Array;
}

const counts = [6, 8, 10, 12, 16, 20, 24] as const;
/** So many places of the loop are looked at for its bends: triangles' own small ones do not count. */
const looks = 96;
/** How far from the plane the way may run, as a share of the loop's length; an edge's length it always may. */
const allowed = 0.01;

/** Places on a closed loop by the length of the way to them, from its place `at` on. */
function measured(points: Float64Array, at: number) {
  const count = points.length / 3;
  const point = (i: number): Place3 => {
    const from = 3 * (i % count);
    return [points[from]!, points[from + 1]!, points[from + 2]!];
  };
  const mixed = (a: Place3, b: Place3, share: number): Place3 => [
    a[0] + share * (b[0] - a[0]),
    a[1] + share * (b[1] - a[1]),
    a[2] + share * (b[2] - a[2]),
  ];
  const first = Math.floor(at) % count;
  const start = mixed(point(first), point(first + 1), at - Math.floor(at));
  const places = [start, ...Array.from({ length: count }, (_, i) => point(first + 1 + i)), start];
  const ways = new Float64Array(places.length);
  for (let i = 1; i < places.length; ++i) {
    const [a, b] = [places[i - 1]!, places[i]!];
    ways[i] = ways[i - 1]! + Math.hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
  }
  const length = ways.at(-1)!;
  const place = (way: number): Place3 => {
    let i = ways.findIndex((one) => one > way);
    if (i < 0) i = ways.length - 1;
    const step = ways[i]! - ways[i - 1]!;
    return step > 0
      ? mixed(places[i - 1]!, places[i]!, Math.min(1, (way - ways[i - 1]!) / step))
      : places[i]!;
  };
  return { length, place };
}

/** Angle between a to b and b to c, radians. */
function bend(a: Place3, b: Place3, c: Place3): number {
  const [p, q] = [
    [b[0] - a[0], b[1] - a[1], b[2] - a[2]] as const,
    [c[0] - b[0], c[1] - b[1], c[2] - b[2]] as const,
  ];
  const lengths = Math.hypot(...p) * Math.hypot(...q);
  if (!(lengths > 0)) return 0;
  return Math.acos(Math.max(-1, Math.min(1, (p[0] * q[0] + p[1] * q[1] + p[2] * q[2]) / lengths)));
}

/** So many points on a closed loop, the first where it is seen: half of them by its length, half by its bends. */
export function spread({ chain, at }: Seen, count: number): Place3[] {
  const { length, place } = measured(chain.points, at);
  const places = Array.from({ length: looks }, (_, i) => place((i / looks) * length));
  const bends = places.map((here, i) => bend(places.at(i - 1)!, here, places[(i + 1) % looks]!));
  const allBends = bends.reduce((sum, one) => sum + one, 0);
  // What is due between place i and the next.
  const due = bends.map((one, i) => {
    const mean = 0.5 * (one + bends[(i + 1) % looks]!);
    return (allBends > 0 ? 0.5 * (mean / allBends) : 0.5 / looks) + 0.5 / looks;
  });
  const points: Place3[] = [];
  let before = 0;
  due.forEach((share, i) => {
    for (; points.length < count && points.length / count < before + share - 1e-9;) {
      const within = (points.length / count - before) / share;
      points.push(place(((i + Math.max(0, within)) / looks) * length));
    }
    before += share;
  });
  return points;
}

/** Farthest that the way through the points runs from the plane. */
export function farthestFrom(plane: Plane, points: readonly Place3[], ways: Ways): number {
  const way = ways.through(points, true);
  let farthest = 0;
  for (let i = 0; i + 2 < way.length; i += 3)
    farthest = Math.max(farthest, Math.abs(distanceTo(plane, way, i)));
  return farthest;
}

/** The fewest points whose way stays near the plane; where it never does, those whose way stays nearest. */
export function ringPoints(seen: Seen, plane: Plane, ways: Ways): Place3[] {
  const { length } = measured(seen.chain.points, seen.at);
  const enough = Math.max(seen.chain.edgeLength, allowed * length);
  let best: Place3[] = [];
  let smallest = Infinity;
  for (const count of counts) {
    const points = spread(seen, count);
    const farthest = farthestFrom(plane, points, ways);
    if (farthest < smallest) [smallest, best] = [farthest, points];
    if (farthest <= enough) break;
  }
  return best;
}
