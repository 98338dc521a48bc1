// SPDX-License-Identifier: GPL-3.0-or-later
/* eslint-disable @typescript-eslint/no-non-null-assertion -- indices stay within the arrays' own lengths */
// A picture's seams: vertices where it has several places are drawn several times, with one normal.
import type { Shading } from './normals';

export interface PicturedShading extends Shading {
  /** u, v per drawn vertex. */
  readonly uvs: Float32Array;
  /** Which vertex of the shading each of these was; its normal is the same. */
  readonly copied: Uint32Array;
}

export function copyNormals(from: Float32Array, { copied, normals }: PicturedShading): void {
  copied.forEach((vertex, at) => {
    for (let k = 0; k < 3; ++k) normals[3 * at + k] = from[3 * vertex + k]!;
  });
}

/** `cornerUvs`: u, v for each of `shading.indices`. What was drawn once stays where it was; copies follow. */
export function apartByUv(shading: Shading, cornerUvs: Float32Array): PicturedShading {
  const count = shading.source.length;
  const indices = shading.indices.slice();
  const uvs: number[] = Array.from({ length: 2 * count }, () => NaN);
  const copied = Array.from({ length: count }, (_, vertex) => vertex);
  /** The next copy of the same vertex, −1 at the last. */
  const next: number[] = Array.from({ length: count }, () => -1);
  for (let corner = 0; corner < indices.length; ++corner) {
    const [u, v] = [cornerUvs[2 * corner]!, cornerUvs[2 * corner + 1]!];
    let at = indices[corner]!;
    while (!Number.isNaN(uvs[2 * at]!) && (uvs[2 * at] !== u || uvs[2 * at + 1] !== v)) {
      if (next[at] === -1) {
        next[at] = copied.length;
        next.push(-1);
        copied.push(copied[at]!);
        uvs.push(NaN, NaN);
      }
      at = next[at]!;
    }
    uvs[2 * at] = u;
    uvs[2 * at + 1] = v;
    indices[corner] = at;
  }
  const result = {
    indices,
    source: Uint32Array.from(copied, (vertex) => shading.source[vertex]!),
    normals: new Float32Array(3 * copied.length),
    // Vertices of no triangle have no place.
    uvs: Float32Array.from(uvs, (value) => (Number.isNaN(value) ? 0 : value)),
    copied: Uint32Array.from(copied),
  };
  copyNormals(shading.normals, result);
  return result;
}
