// SPDX-License-Identifier: GPL-3.0-or-later
// From a line across a limb to the border around it, or to the reason why there is none.
import type { Place3 } from './drawn_parts';
import type { Sight } from './line_across';
import { chainAcross, planeThrough } from './line_across';
import { planeSection } from './plane_section';
import type { Ways } from './ring_points';
import { ringPoints } from './ring_points';

const missed = 'The line does not cross the model. Drag it across a limb.';
const open = 'The model has an open edge where the line crosses it: no border can go all around there.';
const tooCoarse = 'The model has too few triangles for a border there. Drag the line a little further along.';

/** Vertices of the mesh that a border needs on either side: with fewer there is no part. */
const minVertices = 3;

/** Points of a closed border, or a sentence for the maker. */
export function ringAcross(
  { positions, indices }: { readonly positions: Float32Array; readonly indices: ArrayLike<number> },
  sights: readonly Sight[],
  ways: () => Ways,
): readonly Place3[] | string {
  const [first, last] = [sights[0], sights.at(-1)];
  const plane = first && last && planeThrough(first, last);
  const seen = plane && chainAcross(planeSection(positions, indices, plane), plane, sights);
  if (!plane || !seen) return missed;
  if (!seen.chain.closed) return open;
  if (seen.chain.verticesBeside < minVertices) return tooCoarse;
  return ringPoints(seen, plane, ways());
}
