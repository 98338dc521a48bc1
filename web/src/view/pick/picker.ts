// SPDX-License-Identifier: GPL-3.0-or-later
/* eslint-disable @typescript-eslint/no-non-null-assertion -- indices stay within the arrays' own lengths */
// What lies under a ray: one bounding volume hierarchy per mesh, built when first asked for, in a worker
// when the mesh is large, and refitted when the mesh moves.
import * as THREE from 'three';
import { MeshBVH, type SerializedBVH } from 'three-mesh-bvh';
import type { Vec3 } from '../api';
import { BVH_OPTIONS, type BvhRequest } from './bvh_messages';
import type { Surface } from '../render/surface';

export interface SurfaceHit {
  distance: number;
  /** From the scene's origin. */
  point: Vec3;
  triangle: number;
  barycentric: Vec3;
  normal: Vec3;
}

/** Up to here building takes a few milliseconds and is done at once. */
const AT_ONCE = 6000;

interface Entry {
  geometry: THREE.BufferGeometry;
  bvh: MeshBVH | null;
  /** Surface.version of the positions the tree fits. */
  version: number;
}

export class Picker {
  private readonly entries = new Map<Surface, Entry>();
  private worker: Worker | null = null;
  private readonly replies = new Map<number, (tree: SerializedBVH | null) => void>();
  private nextId = 1;
  private disposed = false;

  /** `onReady`: a tree arrived; whatever hovers may ask again. */
  constructor(private readonly onReady: () => void) {}

  /** Starts what `cast` will need. */
  prepare(surface: Surface): void {
    this.entry(surface);
  }

  get busy(): boolean {
    return this.replies.size > 0;
  }

  /** First triangle hit, or null; null too while the tree is being built. */
  cast(surface: Surface, origin: Vec3, direction: Vec3, keep?: (point: Vec3) => boolean): SurfaceHit | null {
    const entry = this.entry(surface);
    if (!entry.bvh) return null;
    if (entry.version !== surface.version) {
      entry.bvh.refit();
      entry.version = surface.version;
    }
    const ray = new THREE.Ray(new THREE.Vector3(...origin), new THREE.Vector3(...direction));
    const hit = keep
      ? entry.bvh
          .raycast(ray, THREE.DoubleSide)
          .sort((a, b) => a.distance - b.distance)
          .find((h) => keep([h.point.x, h.point.y, h.point.z]))
      : entry.bvh.raycastFirst(ray, THREE.DoubleSide);
    if (!hit || hit.faceIndex === undefined || hit.faceIndex === null) return null;
    const point: Vec3 = [hit.point.x, hit.point.y, hit.point.z];
    return {
      distance: hit.distance,
      point,
      triangle: hit.faceIndex,
      ...within(surface, hit.faceIndex, point),
    };
  }

  forget(surface: Surface): void {
    this.entries.get(surface)?.geometry.dispose();
    this.entries.delete(surface);
  }

  dispose(): void {
    this.disposed = true;
    this.worker?.terminate();
    this.worker = null;
    this.entries.clear();
    this.replies.clear();
  }

  private entry(surface: Surface): Entry {
    const found = this.entries.get(surface);
    if (found) return found;
    // A geometry of its own: sharing the arrays, not the graphics buffers.
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(surface.positions, 3));
    geometry.setIndex(new THREE.BufferAttribute(surface.drawnIndices, 1));
    const entry: Entry = { geometry, bvh: null, version: surface.version };
    this.entries.set(surface, entry);
    if (surface.triangleCount <= AT_ONCE) entry.bvh = new MeshBVH(geometry, BVH_OPTIONS);
    else void this.build(surface, entry);
    return entry;
  }

  private async build(surface: Surface, entry: Entry): Promise<void> {
    const tree = await this.ask(surface.positions, surface.drawnIndices);
    if (this.disposed || this.entries.get(surface) !== entry) return;
    entry.bvh = tree
      ? MeshBVH.deserialize(tree, entry.geometry, { setIndex: false })
      : new MeshBVH(entry.geometry, BVH_OPTIONS);
    // The mesh may have moved meanwhile: `cast` refits by version.
    this.onReady();
  }

  private ask(positions: Float32Array, indices: Uint32Array): Promise<SerializedBVH | null> {
    return new Promise((resolve) => {
      try {
        this.worker ??= this.startWorker();
      } catch {
        resolve(null);
        return;
      }
      const request: BvhRequest = {
        id: this.nextId++,
        positions: positions.slice(),
        indices: indices.slice(),
      };
      this.replies.set(request.id, resolve);
      this.worker.postMessage(request, [request.positions.buffer, request.indices.buffer]);
    });
  }

  private startWorker(): Worker {
    const worker = new Worker(new URL('./bvh.worker.ts', import.meta.url), { type: 'module' });
    worker.onmessage = ({ data }: MessageEvent<{ id: number; tree: SerializedBVH }>) => {
      const reply = this.replies.get(data.id);
      this.replies.delete(data.id);
      reply?.(data.tree);
    };
    // Without a worker the page builds the trees itself.
    worker.onerror = () => {
      worker.terminate();
      if (this.worker === worker) this.worker = null;
      const waiting = [...this.replies.values()];
      this.replies.clear();
      for (const reply of waiting) reply(null);
    };
    return worker;
  }
}

/** Weights of the triangle's corners at a point in its plane, and its unit normal. */
function within(surface: Surface, triangle: number, p: Vec3): { barycentric: Vec3; normal: Vec3 } {
  const corner = (k: number): THREE.Vector3 =>
    new THREE.Vector3().fromArray(surface.positions, 3 * surface.drawnIndices[3 * triangle + k]!);
  const t = new THREE.Triangle(corner(0), corner(1), corner(2));
  const weights = t.getBarycoord(new THREE.Vector3(...p), new THREE.Vector3());
  const normal = t.getNormal(new THREE.Vector3());
  return {
    barycentric: weights ? [weights.x, weights.y, weights.z] : [1, 0, 0],
    normal: [normal.x, normal.y, normal.z],
  };
}
