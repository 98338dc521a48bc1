// SPDX-License-Identifier: GPL-3.0-or-later
// The dark frame that holds the sheet, as a mesh.
import type { MeshData, Plate, Vec3 } from '../../view';

export interface Clamp {
  /** Sides of the sheet and of the opening. */
  readonly sheet_mm: readonly [number, number];
  readonly opening_mm: readonly [number, number];
  /** Height of the clamped sheet above the raised platform. */
  readonly height_mm: number;
}

/** Beyond the sheet's rim. */
const lip_mm = 6;
const above_mm = 4;
const below_mm = 12;
const colour: Vec3 = [0.27, 0.265, 0.255];

const outer = ({ sheet_mm, opening_mm }: Clamp, axis: 0 | 1): number =>
  Math.max(sheet_mm[axis], opening_mm[axis]) / 2 + lip_mm;

/** `reach_mm`: how high the sheet comes; the picture is framed with room for it. */
export function clampFrame(clamp: Clamp, reach_mm: number): MeshData {
  const { opening_mm, height_mm } = clamp;
  const [ox, oy] = [outer(clamp, 0), outer(clamp, 1)];
  const [ix, iy] = [opening_mm[0] / 2, opening_mm[1] / 2];
  const [top, bottom] = [height_mm + above_mm, height_mm - below_mm];
  const positions: number[] = [];
  const normals: number[] = [];
  const indices: number[] = [];
  const face = (corners: readonly Vec3[], normal: Vec3) => {
    const at = positions.length / 3;
    for (const corner of corners) {
      positions.push(...corner);
      normals.push(...normal);
    }
    indices.push(at, at + 1, at + 2, at, at + 2, at + 3);
  };
  const ring = (x: number, y: number): (readonly [number, number])[] => [
    [-x, -y],
    [x, -y],
    [x, y],
    [-x, y],
  ];
  const [far, near] = [ring(ox, oy), ring(ix, iy)];
  const sides: readonly Vec3[] = [
    [0, -1, 0],
    [1, 0, 0],
    [0, 1, 0],
    [-1, 0, 0],
  ];
  sides.forEach((out, k) => {
    const [a, b, c, d] = [far[k], far[(k + 1) % 4], near[(k + 1) % 4], near[k]];
    if (!a || !b || !c || !d) return;
    const at = ([x, y]: readonly [number, number], z: number): Vec3 => [x, y, z];
    face([at(a, top), at(b, top), at(c, top), at(d, top)], [0, 0, 1]);
    face([at(d, bottom), at(c, bottom), at(b, bottom), at(a, bottom)], [0, 0, -1]);
    face([at(a, bottom), at(b, bottom), at(b, top), at(a, top)], out);
    face([at(c, bottom), at(d, bottom), at(d, top), at(c, top)], [-out[0], -out[1], 0]);
  });
  for (const [x, y] of near) {
    positions.push(0.6 * x, 0.6 * y, Math.max(top, reach_mm)); // no face: room above
    normals.push(0, 0, 1);
  }
  return {
    positions: Float32Array.from(positions),
    normals: Float32Array.from(normals),
    indices: Uint32Array.from(indices),
    colours: Float32Array.from(positions, (_, i) => colour[i % 3] ?? 0),
  };
}

const plateColour: Vec3 = [0.74, 0.72, 0.69];

/** The platform that closes the opening from below, once it is up. */
export function platform({ opening_mm }: Clamp): MeshData {
  const [x = 0, y = 0] = opening_mm.map((side) => side + 4); // into the frame's walls
  const corners: readonly Vec3[] = [
    [-x / 2, -y / 2, 0],
    [x / 2, -y / 2, 0],
    [x / 2, y / 2, 0],
    [-x / 2, y / 2, 0],
  ];
  return {
    positions: Float32Array.from(corners.flat()),
    normals: Float32Array.from(corners.flatMap(() => [0, 0, 1])),
    indices: Uint32Array.of(0, 1, 2, 0, 2, 3),
    colours: Float32Array.from(corners.flatMap(() => plateColour)),
  };
}

/** What the frame's shadow on the bench is like. */
export function frameShadow(clamp: Clamp): Plate {
  return {
    widthMm: 2 * outer(clamp, 0),
    heightMm: 2 * outer(clamp, 1),
    thicknessMm: below_mm + above_mm,
    centreMm: [0, 0, clamp.height_mm + above_mm],
    direction: [0, 0, -1],
    up: [0, 1, 0],
  };
}
