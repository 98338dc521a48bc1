// SPDX-License-Identifier: GPL-3.0-or-later
// A model as files hold it, on its way to the view.
import type { PlyMesh } from '../../jobs/ply';
import type { MeshData, MeshShading } from '../../view';

/** A mesh, with what the view wants to know of it if that was found beforehand. */
export interface ShadedMesh extends PlyMesh {
  readonly shading?: MeshShading | undefined;
}

export const shadingOf = ({ shading }: ShadedMesh) => (shading ? { shading } : {});

export function scaled(positions: Float32Array, factor: number): Float32Array {
  const result = new Float32Array(positions.length);
  for (let i = 0; i < positions.length; ++i) result[i] = (positions[i] ?? 0) * factor;
  return result;
}

export const originalData = (mesh: ShadedMesh, scale: number): MeshData => ({
  positions: scaled(mesh.positions, scale),
  indices: mesh.indices,
  ...shadingOf(mesh),
  ...(mesh.colours ? { colours: mesh.colours } : {}),
});
