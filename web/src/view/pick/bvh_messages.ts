// SPDX-License-Identifier: GPL-3.0-or-later
/** What the page sends to `bvh.worker.ts`. */
export interface BvhRequest {
  id: number;
  positions: Float32Array;
  indices: Uint32Array;
}

/** Indirect: the mesh's own triangle order, of which values and drawn lines speak, stays. */
export const BVH_OPTIONS = { indirect: true } as const;
