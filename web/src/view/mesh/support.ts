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
const MOST_SAMPLES = 4000;

export interface Support {
  /** x, y, z of the outermost points. */
  points: Float32Array;
  centre: [number, number, number];
  radius: number;
  min: [number, number, number];
  max: [number, number, number];
}

/** Numbers of the outermost points; moving, turning and scaling the points keep them. */
export function outlineOf(positions: ArrayLike<number>, directionCount = 96): Uint32Array {
  const extreme = new Set<number>();
  for (let k = 0; k < 3; ++k) {
    let lowest = k;
    let highest = k;
    for (let i = k; i < positions.length; i += 3) {
      const x = positions[i]!;
      if (!(x >= positions[lowest]!)) lowest = i;
      if (!(x <= positions[highest]!)) highest = i;
    }
    extreme.add((lowest - k) / 3);
    extreme.add((highest - k) / 3);
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
    extreme.add(at / 3);
  }
  return Uint32Array.from(extreme);
}

export function supportOf(positions: Float32Array, outline = outlineOf(positions)): Support {
  const min: [number, number, number] = [Infinity, Infinity, Infinity];
  const max: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  const points = new Float32Array(positions.length > 0 ? 3 * outline.length : 0);
  for (let n = 0; n < points.length / 3; ++n) {
    for (let k = 0; k < 3; ++k) {
      const x = positions[3 * outline[n]! + k]!;
      points[3 * n + k] = x;
      min[k] = Math.min(min[k]!, x);
      max[k] = Math.max(max[k]!, x);
    }
  }
  if (!(max[0] >= min[0]))
    return { points: new Float32Array(0), centre: [0, 0, 0], radius: 1, min: [0, 0, 0], max: [0, 0, 0] };
  const centre: [number, number, number] = [
    (min[0] + max[0]) / 2,
    (min[1] + max[1]) / 2,
    (min[2] + max[2]) / 2,
  ];
  const radius = 0.5 * Math.hypot(max[0] - min[0], max[1] - min[1], max[2] - min[2]);
  return { points, centre, radius: Math.max(radius, 1e-6), min, max };
}
