// SPDX-License-Identifier: GPL-3.0-or-later
// The walls of upright pillars that an eye looks at, what is behind before what is in front.
import type { Plan } from '../plan';
import type { Place, Scene } from '../scene';
import type { EyeCamera } from './eye_camera';

type Foot = readonly [Place, Place];

export interface Strip {
  readonly foot_mm: Foot;
  /** Viewpoints that see it within their pictures, from 0. */
  readonly owners: readonly number[];
}

interface Wall {
  /** Where it stands, from left to right as seen from outside. */
  readonly foot_mm: Foot;
  /** 1 where it faces the eye, 0 where it is seen from its edge. */
  readonly facing: number;
  /** What of it is not bare. */
  readonly strips: readonly Strip[];
}

export interface SeenPillar {
  readonly pillar: number;
  readonly height_mm: number;
  readonly outline_mm: readonly Place[];
  /** That face the eye, the farther ones first. */
  readonly walls: readonly Wall[];
}

/** Tangents to the right of straight ahead, and the distances ahead there. */
interface Span {
  readonly from: number;
  readonly to: number;
  readonly near_mm: number;
  readonly far_mm: number;
}

function spanOf(camera: EyeCamera, [a, b]: Foot): Span {
  const [aheadA, aheadB] = [camera.ahead_mm(a), camera.ahead_mm(b)];
  return {
    from: camera.aside_mm(a) / aheadA,
    to: camera.aside_mm(b) / aheadB,
    near_mm: aheadA,
    far_mm: aheadB,
  };
}

/** Distance ahead where the ray with this tangent meets the wall: 1 / ahead is linear in the tangent. */
function aheadAt({ from, to, near_mm, far_mm }: Span, tangent: number): number {
  const share = (tangent - from) / (to - from);
  return 1 / ((1 - share) / near_mm + share / far_mm);
}

/** Cosine between what stands square on a wall and the way to the eye; negative where it is turned away. */
function facing(camera: EyeCamera, [a, b]: Foot): number {
  const [x, y] = [b[0] - a[0], b[1] - a[1]];
  const to = [camera.eye_mm[0] - 0.5 * (a[0] + b[0]), camera.eye_mm[1] - 0.5 * (a[1] + b[1])] as const;
  return (y * to[0] - x * to[1]) / (Math.hypot(x, y) * Math.hypot(...to));
}
const isAhead = (camera: EyeCamera, [a, b]: Foot): boolean =>
  Math.min(camera.ahead_mm(a), camera.ahead_mm(b)) > camera.nearest_mm;

const pieces = (line: readonly Place[]): Foot[] =>
  line.slice(1).map((place, i) => [line[i] ?? place, place] as const);

/** The core writes places of surfaces to far more digits than this. */
const same_mm = 0.01;
function liesOn([from, to]: Foot, [a, b]: Foot): boolean {
  const along = [b[0] - a[0], b[1] - a[1]] as const;
  const length = Math.hypot(...along);
  const middle = [0.5 * (from[0] + to[0]) - a[0], 0.5 * (from[1] + to[1]) - a[1]] as const;
  const share = (middle[0] * along[0] + middle[1] * along[1]) / length ** 2;
  const off_mm = Math.abs(middle[0] * along[1] - middle[1] * along[0]) / length;
  return off_mm < same_mm && share > 0 && share < 1;
}

function stripsOf({ viewpoints, shared }: Plan, pillar: number): Strip[] {
  const isHere = (surface: { readonly pillar: number }) => surface.pillar === pillar + 1;
  return [
    ...viewpoints.flatMap(({ surfaces }, v) =>
      surfaces
        .filter(isHere)
        .flatMap(({ line_mm }) => pieces(line_mm).map((foot_mm) => ({ foot_mm, owners: [v] }))),
    ),
    ...shared
      .filter(isHere)
      .flatMap(({ line_mm, viewpoints: owners }) =>
        pieces(line_mm).map((foot_mm) => ({ foot_mm, owners: owners.map((v) => v - 1) })),
      ),
  ];
}

function wallsOf(camera: EyeCamera, outline: readonly Place[], strips: readonly Strip[]): Wall[] {
  const distance = ({ foot_mm: [a, b] }: Wall) => camera.ahead_mm(a) + camera.ahead_mm(b);
  return pieces([...outline, ...outline.slice(0, 1)])
    .filter((foot_mm) => isAhead(camera, foot_mm) && facing(camera, foot_mm) > 0)
    .map((foot_mm) => ({
      foot_mm,
      facing: facing(camera, foot_mm),
      strips: strips.filter((strip) => liesOn(strip.foot_mm, foot_mm)),
    }))
    .sort((a, b) => distance(b) - distance(a));
}

/** Whether the first stands behind the second; null: no ray meets both. Pillars do not overlap, so one ray decides. */
function isBehind(first: readonly Span[], second: readonly Span[]): boolean | null {
  for (const a of first)
    for (const b of second) {
      const [from, to] = [Math.max(a.from, b.from), Math.min(a.to, b.to)];
      if (!(to > from)) continue;
      const middle = 0.5 * (from + to);
      return aheadAt(a, middle) > aheadAt(b, middle);
    }
  return null;
}

/** Pillars that stand ahead of the eye, each before those that it may hide. */
export function seenPillars(camera: EyeCamera, plan: Plan, scene: Scene): SeenPillar[] {
  const seen = plan.pillars_mm.flatMap((outline_mm, pillar) => {
    const walls = wallsOf(camera, outline_mm, stripsOf(plan, pillar));
    const height_mm = scene.pillars[pillar]?.height_mm ?? 0;
    const spans = walls.map(({ foot_mm }) => spanOf(camera, foot_mm));
    return spans.length > 0 ? [{ pillar, height_mm, outline_mm, walls, spans }] : [];
  });
  // Of convex outlines that do not overlap, "behind" has no circles; where there is one, the farthest goes first.
  const waiting = new Set(seen);
  const behind = new Map(
    seen.map((one) => [
      one,
      seen.filter((other) => other !== one && isBehind(other.spans, one.spans) === true),
    ]),
  );
  const distance = ({ outline_mm }: SeenPillar) =>
    Math.max(...outline_mm.map((place) => camera.ahead_mm(place)));
  const sorted: SeenPillar[] = [];
  const byDistance = [...seen].sort((a, b) => distance(b) - distance(a));
  while (waiting.size > 0) {
    const free = (one: (typeof seen)[number]) => !behind.get(one)?.some((other) => waiting.has(other));
    const left = byDistance.filter((one) => waiting.has(one));
    const next = left.find(free) ?? left[0];
    if (next === undefined) break;
    waiting.delete(next);
    const { pillar, height_mm, outline_mm, walls } = next;
    sorted.push({ pillar, height_mm, outline_mm, walls });
  }
  return sorted;
}
