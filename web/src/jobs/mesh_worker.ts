// SPDX-License-Identifier: GPL-3.0-or-later
// Reads meshes off the main thread.
import { parseFilm, parseNodes, parsePrinted, parseSolid } from './glb';
import type { MeshReply, MeshRequest } from './mesh_reader';
import { parsePly } from './ply';
import { parsePolylines } from './polylines';

const readers = {
  ply: parsePly,
  film: parseFilm,
  printed: parsePrinted,
  solid: parseSolid,
  nodes: parseNodes,
  polylines: parsePolylines,
} as const;

/** The memory of all typed arrays in a value, to be handed over rather than copied. */
function buffersOf(value: unknown, found = new Set<ArrayBuffer>()): Set<ArrayBuffer> {
  if (ArrayBuffer.isView(value)) found.add(value.buffer as ArrayBuffer);
  else if (typeof value === 'object' && value !== null)
    for (const item of Object.values(value)) buffersOf(item, found);
  return found;
}

self.onmessage = ({ data: { id, kind, bytes } }: MessageEvent<MeshRequest>) => {
  const reply = (message: MeshReply, transfer: Transferable[] = []) =>
    self.postMessage(message, { transfer });
  try {
    const mesh = readers[kind](bytes);
    reply({ id, mesh }, [...buffersOf(mesh)]);
  } catch (thrown) {
    reply({ id, error: thrown instanceof Error ? thrown.message : String(thrown) });
  }
};
