// SPDX-License-Identifier: GPL-3.0-or-later
// What a surface needs to know about its mesh before it is drawn. Half a second for a large mesh, so it can
// be found away from the page's thread.
import type { MeshData, MeshShading } from '../api';
import { isClosed, shadingFor, signedVolume } from './normals';
import { outlineOf } from './support';

export interface ShadingRequest {
  id: number;
  positions: Float32Array | Float64Array;
  indices: Uint32Array;
}

export interface ShadingReply {
  id: number;
  /** Null where the mesh could not be understood: whoever draws it finds out. */
  shading: MeshShading | null;
}

export function findShading(positions: ArrayLike<number>, indices: Uint32Array): MeshShading {
  const { indices: drawn, source, normals } = shadingFor(positions, indices);
  const closed = isClosed(indices, positions.length / 3);
  const split = source.length > positions.length / 3;
  return {
    indices: split ? drawn : null,
    source: split ? source : null,
    normals,
    outline: outlineOf(positions),
    closed,
    outward: closed && signedVolume(positions, indices) > 0,
  };
}

/** Below, asking a worker takes longer than doing it. */
const AT_ONCE = 4000;

let worker: Worker | null = null;
let nextId = 1;
const waiting = new Map<number, (shading: MeshShading | null) => void>();

function ask(mesh: MeshData): Promise<MeshShading | null> {
  if (!worker) {
    worker = new Worker(new URL('./shading.worker.ts', import.meta.url), { type: 'module' });
    worker.onmessage = ({ data }: MessageEvent<ShadingReply>) => {
      waiting.get(data.id)?.(data.shading);
      waiting.delete(data.id);
    };
    worker.onerror = () => {
      for (const resolve of waiting.values()) resolve(null);
      waiting.clear();
      worker = null;
    };
  }
  const request: ShadingRequest = { id: nextId++, positions: mesh.positions, indices: mesh.indices };
  worker.postMessage(request);
  return new Promise((resolve) => waiting.set(request.id, resolve));
}

/** The shading of a mesh, found in a worker; give it along as `MeshData.shading`. Scaling and moving keep it. */
export async function prepareShading(
  mesh: Pick<MeshData, 'positions' | 'indices'>,
): Promise<MeshShading | undefined> {
  if (mesh.indices.length < 3 * AT_ONCE) return undefined;
  return (await ask(mesh)) ?? undefined;
}

/** The shading of a mesh that was turned by `rotation` (3 x 3, row by row), and moved or scaled. */
export function turnedShading(shading: MeshShading, rotation: readonly number[]): MeshShading {
  const normals = new Float32Array(shading.normals.length);
  for (let i = 0; i < normals.length; i += 3)
    for (let k = 0; k < 3; ++k) {
      let sum = 0;
      for (let j = 0; j < 3; ++j) sum += (rotation[3 * k + j] ?? 0) * (shading.normals[i + j] ?? 0);
      normals[i + k] = sum;
    }
  return { ...shading, normals };
}
