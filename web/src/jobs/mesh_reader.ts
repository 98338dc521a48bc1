// SPDX-License-Identifier: GPL-3.0-or-later
// The page's side of `mesh_worker`: meshes without a long task on the main thread.
import { JobError } from './contract';
import type { Film, NamedSolid, Printed, Solid } from './glb';
import type { PlyMesh } from './ply';

interface Kinds {
  ply: PlyMesh;
  film: Film;
  printed: Printed;
  solid: Solid;
  nodes: NamedSolid[];
  polylines: Float32Array<ArrayBuffer>[];
}

export type MeshRequest = { id: number; kind: keyof Kinds; bytes: Uint8Array<ArrayBuffer> };
export type MeshReply = { id: number } & ({ mesh: Kinds[keyof Kinds] } | { error: string });

let worker: Worker | null = null;
let nextId = 1;
const waiting = new Map<number, (reply: MeshReply) => void>();

function ask(kind: keyof Kinds, bytes: Uint8Array<ArrayBuffer>): Promise<MeshReply> {
  if (worker === null) {
    worker = new Worker(new URL('./mesh_worker.ts', import.meta.url), { type: 'module' });
    worker.onmessage = ({ data }: MessageEvent<MeshReply>) => {
      waiting.get(data.id)?.(data);
      waiting.delete(data.id);
    };
    worker.onerror = () => {
      for (const [id, resolve] of waiting) resolve({ id, error: 'The mesh could not be read.' });
      waiting.clear();
      worker = null;
    };
  }
  const request: MeshRequest = { id: nextId++, kind, bytes };
  worker.postMessage(request); // copied: the caller may keep its bytes
  return new Promise((resolve) => waiting.set(request.id, resolve));
}

const failed = (message: string) => new JobError({ code: 'internal', where: '', message });

async function read<K extends keyof Kinds>(kind: K, bytes: Uint8Array<ArrayBuffer>): Promise<Kinds[K]> {
  const reply = await ask(kind, bytes);
  if (!('mesh' in reply)) throw failed('error' in reply ? reply.error : 'No mesh.');
  return reply.mesh as Kinds[K];
}

export const readPly = (bytes: Uint8Array<ArrayBuffer>) => read('ply', bytes);
export const readFilm = (bytes: Uint8Array<ArrayBuffer>) => read('film', bytes);
export const readPrinted = (bytes: Uint8Array<ArrayBuffer>) => read('printed', bytes);
export const readSolid = (bytes: Uint8Array<ArrayBuffer>) => read('solid', bytes);
export const readNodes = (bytes: Uint8Array<ArrayBuffer>) => read('nodes', bytes);
export const readPolylines = (bytes: Uint8Array<ArrayBuffer>) => read('polylines', bytes);
