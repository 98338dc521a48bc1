// SPDX-License-Identifier: GPL-3.0-or-later
// The page's side of `ply_worker`: meshes without a long task on the main thread.
import { JobError } from './contract';
import type { PlyMesh } from './ply';

export type MeshRequest = { id: number; bytes: Uint8Array<ArrayBuffer> };
export type MeshReply = { id: number } & ({ mesh: PlyMesh } | { error: string });

let worker: Worker | null = null;
let nextId = 1;
const waiting = new Map<number, (reply: MeshReply) => void>();

function ask(bytes: Uint8Array<ArrayBuffer>): Promise<MeshReply> {
  if (worker === null) {
    worker = new Worker(new URL('./ply_worker.ts', import.meta.url), { type: 'module' });
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
  const id = nextId++;
  const request: MeshRequest = { id, bytes };
  worker.postMessage(request); // copied: the caller may keep its bytes
  return new Promise((resolve) => waiting.set(id, resolve));
}

const failed = (message: string) => new JobError({ code: 'internal', where: '', message });

export async function readPly(bytes: Uint8Array<ArrayBuffer>): Promise<PlyMesh> {
  const reply = await ask(bytes);
  if (!('mesh' in reply)) throw failed('error' in reply ? reply.error : 'No mesh.');
  return reply.mesh;
}
