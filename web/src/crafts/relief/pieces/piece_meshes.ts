// SPDX-License-Identifier: GPL-3.0-or-later
// Pieces of a relief where the view draws them: in place, or pulled apart, in the model's axes.
import type { Report } from '../../../jobs/contract';
import type { NamedSolid } from '../../../jobs/glb';
import { vectorOf } from '../../../shared/session/report';
import type { Marker, MeshData, Vec3 } from '../../../view';

/** A solid in mm: right, up and towards the viewer from the middle of the plate's front. */
export interface Piece extends NamedSolid {
  readonly low: Vec3;
  readonly high: Vec3;
}

export function pieceOf(solid: NamedSolid): Piece {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  solid.positions.forEach((value, i) => {
    const axis = i % 3;
    low[axis] = Math.min(low[axis] ?? 0, value);
    high[axis] = Math.max(high[axis] ?? 0, value);
  });
  return { ...solid, low: low as unknown as Vec3, high: high as unknown as Vec3 };
}

const middleOf = ({ low, high }: { low: Vec3; high: Vec3 }): Vec3 => [
  (low[0] + high[0]) / 2,
  (low[1] + high[1]) / 2,
  (low[2] + high[2]) / 2,
];

/** How far each piece is moved: `apart` = 1 sets them half as far again from the middle of all. */
export function shiftsOf(pieces: readonly Piece[], apart: number): Vec3[] {
  const middles = pieces.map(middleOf);
  const mean = [0, 1, 2].map((k) => middles.reduce((sum, m) => sum + (m[k] ?? 0), 0) / middles.length);
  return middles.map(
    (m) => [0, 1, 2].map((k) => 0.5 * apart * ((m[k] ?? 0) - (mean[k] ?? 0))) as unknown as Vec3,
  );
}

/** From the plate's axes to the model's, as the report says how they lie. */
function toModel(report: Report): (p: Vec3) => Vec3 {
  const right = vectorOf(report, 'right') ?? [1, 0, 0];
  const up = vectorOf(report, 'up') ?? [0, 1, 0];
  const look = vectorOf(report, 'direction') ?? [0, 0, -1];
  const centre = vectorOf(report, 'plate_centre_mm') ?? [0, 0, 0];
  const one = (k: 0 | 1 | 2, [x, y, z]: Vec3) => centre[k] + x * right[k] + y * up[k] - z * look[k];
  return (p) => [one(0, p), one(1, p), one(2, p)];
}

export interface PlacedPieces {
  readonly mesh: MeshData;
  /** One number a piece, at the middle of its front. */
  readonly markers: Marker[];
}

export function placed(pieces: readonly Piece[], report: Report, apart: number): PlacedPieces {
  const place = toModel(report);
  const shifts = shiftsOf(pieces, apart);
  const positions = new Float32Array(pieces.reduce((sum, piece) => sum + piece.positions.length, 0));
  const indices = new Uint32Array(pieces.reduce((sum, piece) => sum + piece.indices.length, 0));
  const markers: Marker[] = [];
  let [vertex, corner] = [0, 0];
  pieces.forEach((piece, n) => {
    const shift = shifts[n] ?? [0, 0, 0];
    const first = vertex / 3;
    for (let i = 0; i < piece.positions.length; i += 3) {
      const at = (k: 0 | 1 | 2) => (piece.positions[i + k] ?? 0) + shift[k];
      positions.set(place([at(0), at(1), at(2)]), vertex);
      vertex += 3;
    }
    for (const index of piece.indices) indices[corner++] = first + index;
    const [x, y] = middleOf(piece);
    const positionMm = place([x + shift[0], y + shift[1], piece.high[2] + shift[2]]);
    markers.push({ id: piece.name, positionMm, kind: 'set', label: piece.name.replace(/^Piece /, '') });
  });
  return { mesh: { positions, indices }, markers };
}
