// SPDX-License-Identifier: GPL-3.0-or-later
// Reads meshes off the main thread.
import { parsePly } from './ply';
import type { MeshReply, MeshRequest } from './mesh_reader';

self.onmessage = ({ data }: MessageEvent<MeshRequest>) => {
  const reply = (message: MeshReply, transfer: Transferable[] = []) =>
    self.postMessage(message, { transfer });
  try {
    const mesh = parsePly(data.bytes);
    const arrays = [mesh.positions, mesh.indices, mesh.colours, ...Object.values(mesh.attributes)];
    reply(
      { id: data.id, mesh },
      arrays.flatMap((array) => (array ? [array.buffer] : [])),
    );
  } catch (thrown) {
    reply({ id: data.id, error: thrown instanceof Error ? thrown.message : String(thrown) });
  }
};
