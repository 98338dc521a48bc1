// SPDX-License-Identifier: GPL-3.0-or-later
/* eslint-disable @typescript-eslint/no-non-null-assertion -- indices stay within the arrays' own lengths */
// The outline of a point set by few points: its furthest points in many directions. Framing and shadow
// bounds use these instead of every vertex.

/** `count` directions spread evenly over the sphere (golden spiral). */
export function sphereDirections(count: number): Float32Array {
  const out = new Float32Array(3 * count);
  for (let i = 0; i < count; ++i) {
    const z = 1 - (2 * i + 1) / count;
    const r = Math.sqrt(1 - z * z);
    const a = i * Math.PI * (3 - Math.sqrt(5));
    out.set([r * Math.cos(a), r * Math.sin(a), z], 3 * i);
  }
  return out;
}

/** Most points looked at in every direction; the box's own extremes are always exact. */
const MOST_SAMPLES = 8000;

export interface Support {
  /** x, y, z of the outermost points. */
  points: Float32Array;
  centre: [number, number, number];
  radius: number;
  min: [number, number, number];
  max: [number, number, number];
}

export function supportOf(positions: Float32Array, directionCount = 96): Support {
  const min: [number, number, number] = [Infinity, Infinity, Infinity];
  const max: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  const extreme = new Set<number>();
  const lowest = [0, 0, 0];
  const highest = [0, 0, 0];
  for (let i = 0; i < positions.length; i += 3) {
    for (let k = 0; k < 3; ++k) {
      const x = positions[i + k]!;
      if (x < min[k]!) {
        min[k] = x;
        lowest[k] = i;
      }
      if (x > max[k]!) {
        max[k] = x;
        highest[k] = i;
      }
    }
  }
  if (!(max[0] >= min[0]))
    return { points: new Float32Array(0), centre: [0, 0, 0], radius: 1, min: [0, 0, 0], max: [0, 0, 0] };
  for (let k = 0; k < 3; ++k) {
    extreme.add(lowest[k]!);
    extreme.add(highest[k]!);
  }
  const stride = 3 * Math.max(1, Math.floor(positions.length / 3 / MOST_SAMPLES));
  const directions = sphereDirections(directionCount);
  for (let d = 0; d < directions.length; d += 3) {
    const dx = directions[d]!;
    const dy = directions[d + 1]!;
    const dz = directions[d + 2]!;
    let best = -Infinity;
    let at = 0;
    for (let i = 0; i < positions.length; i += stride) {
      const s = dx * positions[i]! + dy * positions[i + 1]! + dz * positions[i + 2]!;
      if (s > best) {
        best = s;
        at = i;
      }
    }
    extreme.add(at);
  }
  const points = new Float32Array(3 * extreme.size);
  let n = 0;
  for (const i of extreme) {
    points.set(positions.subarray(i, i + 3), n);
    n += 3;
  }
  const centre: [number, number, number] = [
    (min[0] + max[0]) / 2,
    (min[1] + max[1]) / 2,
    (min[2] + max[2]) / 2,
  ];
  const radius = 0.5 * Math.hypot(max[0] - min[0], max[1] - min[1], max[2] - min[2]);
  return { points, centre, radius: Math.max(radius, 1e-6), min, max };
}
