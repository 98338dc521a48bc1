// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { pieceOf, placed, shiftsOf } from './piece_meshes';

/** A flat triangle whose box begins at `x`, 2 mm wide and high. */
const triangle = (name: string, x: number) =>
  pieceOf({
    name,
    positions: new Float32Array([x, 0, 1, x + 2, 0, 1, x, 2, 3]),
    indices: new Uint32Array([0, 1, 2]),
  });

describe('pieces of a relief', () => {
  const pieces = [triangle('Piece 1', -2), triangle('Piece 2', 0)];

  it('stay where they are until they are pulled apart, then away from their middle', () => {
    expect(shiftsOf(pieces, 0)).toEqual([
      [-0, 0, 0],
      [0, 0, 0],
    ]);
    expect(shiftsOf(pieces, 1)).toEqual([
      [-0.5, 0, 0],
      [0.5, 0, 0],
    ]);
  });

  it('stand in the axes of the model, with their numbers before their fronts', () => {
    const report = { right: [0, 0, 1], up: [0, 1, 0], direction: [1, 0, 0], plate_centre_mm: [10, 20, 30] };
    const { mesh, markers } = placed(pieces, report, 0);
    // 1 mm towards the viewer is 1 mm against the looking direction.
    expect([...mesh.positions.slice(0, 3)]).toEqual([9, 20, 28]);
    expect([...mesh.indices]).toEqual([0, 1, 2, 3, 4, 5]);
    expect(markers).toEqual([
      { id: 'Piece 1', positionMm: [7, 21, 29], kind: 'set', label: '1' },
      { id: 'Piece 2', positionMm: [7, 21, 31], kind: 'set', label: '2' },
    ]);
  });
});
