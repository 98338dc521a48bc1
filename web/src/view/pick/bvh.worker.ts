// SPDX-License-Identifier: GPL-3.0-or-later
// Builds a bounding volume hierarchy away from the page's thread.
import { BufferAttribute, BufferGeometry } from 'three';
import { MeshBVH } from 'three-mesh-bvh';
import { BVH_OPTIONS, type BvhRequest } from './bvh_messages';

self.onmessage = ({ data }: MessageEvent<BvhRequest>) => {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(data.positions, 3));
  geometry.setIndex(new BufferAttribute(data.indices, 1));
  const serialized = MeshBVH.serialize(new MeshBVH(geometry, BVH_OPTIONS), { cloneBuffers: false });
  // The index is the page's own: only the tree travels back.
  const { index: _index, ...tree } = serialized as unknown as Record<string, unknown> & { index?: unknown };
  self.postMessage({ id: data.id, tree }, { transfer: serialized.roots as unknown as ArrayBuffer[] });
};
