// SPDX-License-Identifier: GPL-3.0-or-later
// The plate behind a relief, and the ground below an object, as meshes in mm from the scene's origin.
import type { MeshData, Plate, Vec3, Viewpoint } from '../api';
import { add, along, scale, viewerAxes } from '../vector';

export interface PlateFrame {
  centre: Vec3;
  right: Vec3;
  up: Vec3;
  /** Into the plate. */
  forward: Vec3;
  halfWidth: number;
  halfHeight: number;
  thickness: number;
}

export function plateFrame(plate: Plate, viewpoint: Pick<Viewpoint, 'direction' | 'up'>): PlateFrame {
  const axes = viewerAxes(plate.direction ?? viewpoint.direction, plate.up ?? viewpoint.up);
  return {
    ...axes,
    centre: plate.centreMm,
    halfWidth: plate.widthMm / 2,
    halfHeight: plate.heightMm / 2,
    thickness: Math.max(0, plate.thicknessMm),
  };
}

/** The four corners of the front (or back) face: lower left, lower right, upper right, upper left. */
export function plateCorners(frame: PlateFrame, depth = 0): [Vec3, Vec3, Vec3, Vec3] {
  const centre = along(frame.centre, frame.forward, depth);
  const r = scale(frame.right, frame.halfWidth);
  const u = scale(frame.up, frame.halfHeight);
  const corner = (sx: number, sy: number): Vec3 => add(add(centre, scale(r, sx)), scale(u, sy));
  return [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
}

/** A rectangle of two triangles with uvs, facing against `forward`. */
export function rectangle(corners: readonly [Vec3, Vec3, Vec3, Vec3], facing: Vec3): MeshData {
  const normals = new Float32Array(12);
  for (let i = 0; i < 4; ++i) normals.set(facing, 3 * i);
  return {
    positions: Float64Array.from(corners.flatMap((c) => [...c])),
    indices: Uint32Array.of(0, 1, 2, 0, 2, 3),
    normals,
    uvs: Float32Array.of(0, 0, 1, 0, 1, 1, 0, 1),
  };
}

export function plateFront(frame: PlateFrame): MeshData {
  return rectangle(plateCorners(frame), scale(frame.forward, -1));
}

/** Sides and back of the slab; null for a single sheet. */
export function plateBody(frame: PlateFrame): MeshData | null {
  if (frame.thickness === 0) return null;
  const front = plateCorners(frame);
  const back = plateCorners(frame, frame.thickness);
  const positions: number[] = [];
  const normals: number[] = [];
  const indices: number[] = [];
  const face = (a: Vec3, b: Vec3, c: Vec3, d: Vec3, n: Vec3): void => {
    const at = positions.length / 3;
    for (const p of [a, b, c, d]) {
      positions.push(...p);
      normals.push(...n);
    }
    indices.push(at, at + 1, at + 2, at, at + 2, at + 3);
  };
  const { right, up, forward } = frame;
  face(back[0], back[1], front[1], front[0], scale(up, -1));
  face(front[1], back[1], back[2], front[2], right);
  face(front[3], front[2], back[2], back[3], up);
  face(back[0], front[0], front[3], back[3], scale(right, -1));
  face(back[1], back[0], back[3], back[2], forward);
  return {
    positions: Float64Array.from(positions),
    indices: Uint32Array.from(indices),
    normals: Float32Array.from(normals),
  };
}

/** A square of ground under the lowest point along `up`, `reach` radii to each side. */
export function groundFrame(
  centre: Vec3,
  radius: number,
  lowest: number,
  up: Vec3,
  reach: number,
): PlateFrame {
  const axes = viewerAxes(scale(up, -1), Math.abs(up[1]) < 0.9 ? [0, 1, 0] : [0, 0, -1]);
  const level = lowest - (centre[0] * up[0] + centre[1] * up[1] + centre[2] * up[2]);
  return {
    ...axes,
    centre: along(centre, up, level),
    halfWidth: reach * radius,
    halfHeight: reach * radius,
    thickness: 0,
  };
}
