// SPDX-License-Identifier: GPL-3.0-or-later
// Whether new shapes differ from those already on the graphics card.
import type { Plate, Vec3 } from './api';

export function sameIndices(a: Uint32Array, b: Uint32Array): boolean {
  if (a === b) return true;
  if (a.length !== b.length) return false;
  for (let i = 0; i < a.length; ++i) if (a[i] !== b[i]) return false;
  return true;
}

/** Drawn alike; the relief's thickness is only spoken of. */
export function samePlate(a: Plate | null, b: Plate | null): boolean {
  if (!a || !b) return a === b;
  if (a.mesh !== b.mesh) return false;
  const drawn = (p: Plate): string =>
    JSON.stringify([p.widthMm, p.heightMm, p.thicknessMm, p.centreMm, p.direction, p.up]);
  return drawn(a) === drawn(b);
}

/** Bounds of x, y, z triples; null where there are none or they are not numbers. */
export function boxOf(positions: ArrayLike<number>): { low: Vec3; high: Vec3 } | null {
  const low: [number, number, number] = [Infinity, Infinity, Infinity];
  const high: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i + 2 < positions.length; i += 3) {
    for (const k of [0, 1, 2] as const) {
      const x = positions[i + k] as number;
      if (x < low[k]) low[k] = x;
      if (x > high[k]) high[k] = x;
    }
  }
  return [...low, ...high].every(Number.isFinite) ? { low, high } : null;
}
