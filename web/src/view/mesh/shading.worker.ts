// SPDX-License-Identifier: GPL-3.0-or-later
import { findShading, type ShadingReply, type ShadingRequest } from './shading';

self.onmessage = ({ data }: MessageEvent<ShadingRequest>) => {
  let reply: ShadingReply = { id: data.id, shading: null };
  try {
    reply = { id: data.id, shading: findShading(data.positions, data.indices) };
  } catch {
    // The page tries itself and says what it finds.
  }
  const { shading } = reply;
  const arrays = shading ? [shading.normals, shading.outline, shading.indices, shading.source] : [];
  self.postMessage(reply, {
    transfer: arrays.flatMap((array) => (array ? [array.buffer as ArrayBuffer] : [])),
  });
};
