// SPDX-License-Identifier: GPL-3.0-or-later
// The sides that a model can stand on: the flat regions of its convex hull.
import { ConvexHull, type Face, type HalfEdge } from 'three/examples/jsm/math/ConvexHull.js';
import { Vector3 } from 'three';
import type { FlatSide, Vec3 } from '../api';

/** Neighbours that lean less than this to the largest triangle belong to the same side. */
const sameSide = Math.cos(Math.PI / 180);
/** Of the hull's surface: smaller sides are no feet. */
const minShare = 0.005;
const maxSides = 24;

/** The largest first. */
export function findFlatSides(positions: ArrayLike<number>): FlatSide[] {
  if (positions.length < 12) return [];
  const points = Array.from(
    { length: positions.length / 3 },
    (_, i) => new Vector3(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]),
  );
  const hull = new ConvexHull().setFromPoints(points);
  const total = hull.faces.reduce((sum, face) => sum + face.area, 0);
  const taken = new Set<Face>();
  const sides: FlatSide[] = [];
  for (const seed of [...hull.faces].sort((a, b) => b.area - a.area)) {
    if (!(seed.area > 0) || taken.has(seed)) continue;
    sides.push(sideOf(grow(seed, taken)));
  }
  return sides
    .filter(({ area }) => area >= minShare * total)
    .sort((a, b) => b.area - a.area)
    .slice(0, maxSides);
}

/** The seed and all that is reached from it without leaning away. */
function grow(seed: Face, taken: Set<Face>): [Face, ...Face[]] {
  const group: [Face, ...Face[]] = [seed];
  taken.add(seed);
  for (const face of group)
    for (const { twin } of edgesOf(face)) {
      if (taken.has(twin.face) || twin.face.normal.dot(seed.normal) < sameSide) continue;
      taken.add(twin.face);
      group.push(twin.face);
    }
  return group;
}

const edgesOf = (face: Face): HalfEdge[] => [face.getEdge(0), face.getEdge(1), face.getEdge(2)];
const tuple = ({ x, y, z }: Vector3): Vec3 => [x, y, z];

/** Of triangles, the one that the model comes to stand on first. */
function sideOf(group: readonly [Face, ...Face[]]): FlatSide {
  const [seed] = group;
  const members = new Set(group);
  const next = new Map<Vector3, Vector3>();
  for (const face of group)
    for (const edge of edgesOf(face))
      if (!members.has(edge.twin.face)) next.set(edge.tail().point, edge.head().point);
  return {
    normal: tuple(seed.normal),
    area: group.reduce((sum, face) => sum + face.area, 0),
    support: edgesOf(seed).map((edge) => tuple(edge.head().point)),
    outline: longestLoop(next),
  };
}

/** Of the border's pieces, from point to point. */
function longestLoop(next: Map<Vector3, Vector3>): Vec3[] {
  let longest: Vector3[] = [];
  while (next.size > 0) {
    const loop: Vector3[] = [];
    let at = next.keys().next().value;
    while (at !== undefined) {
      const to = next.get(at);
      if (to === undefined) break;
      next.delete(at);
      loop.push(at);
      at = to;
    }
    if (loop.length > longest.length) longest = loop;
  }
  return longest.map(tuple);
}

/** Below, asking a worker takes longer than doing it. */
const atOnce = 4000;

/** The sides that a mesh can stand on, the largest first; found in a worker where that takes long. */
export async function prepareFlatSides(positions: Float32Array | Float64Array): Promise<FlatSide[]> {
  if (positions.length < 3 * atOnce) return findFlatSides(positions);
  const worker = new Worker(new URL('./flat_sides.worker.ts', import.meta.url), { type: 'module' });
  try {
    const sides = await new Promise<FlatSide[] | null>((resolve) => {
      worker.onmessage = ({ data }: MessageEvent<FlatSide[]>) => resolve(data);
      worker.onerror = () => resolve(null);
      worker.postMessage(positions);
    });
    return sides ?? findFlatSides(positions);
  } finally {
    worker.terminate();
  }
}
