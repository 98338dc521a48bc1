// SPDX-License-Identifier: GPL-3.0-or-later
/* eslint-disable @typescript-eslint/no-non-null-assertion -- indices stay within the arrays' own lengths */
// Where a plane cuts a mesh: the outline as pieces of line.

/** Pieces (start, end) along which the plane normal . p = offset crosses the triangles. */
export function cutOutline(
  positions: ArrayLike<number>,
  indices: Uint32Array,
  normal: readonly [number, number, number],
  offset: number,
): Float32Array {
  const vertexCount = positions.length / 3;
  const side = new Float32Array(vertexCount);
  for (let v = 0; v < vertexCount; ++v) {
    side[v] =
      normal[0] * positions[3 * v]! +
      normal[1] * positions[3 * v + 1]! +
      normal[2] * positions[3 * v + 2]! -
      offset;
  }
  const out: number[] = [];
  const point = (a: number, b: number): void => {
    const t = side[a]! / (side[a]! - side[b]!);
    for (let k = 0; k < 3; ++k) {
      const p = positions[3 * a + k]!;
      out.push(p + t * (positions[3 * b + k]! - p));
    }
  };
  for (let t = 0; t < indices.length; t += 3) {
    const a = indices[t]!;
    const b = indices[t + 1]!;
    const c = indices[t + 2]!;
    // A vertex on the plane counts as above: every crossed triangle is cut in exactly two edges.
    const sa = side[a]! >= 0;
    const sb = side[b]! >= 0;
    const sc = side[c]! >= 0;
    if (sa === sb && sb === sc) continue;
    const alone = sa === sb ? c : sa === sc ? b : a;
    const next = alone === a ? b : alone === b ? c : a;
    const last = alone === a ? c : alone === b ? a : b;
    // From below to above on the left, so that outlines run one way round.
    if (side[alone]! >= 0) {
      point(alone, next);
      point(alone, last);
    } else {
      point(alone, last);
      point(alone, next);
    }
  }
  return Float32Array.from(out);
}
