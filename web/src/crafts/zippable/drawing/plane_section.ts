// SPDX-License-Identifier: GPL-3.0-or-later
/* eslint-disable @typescript-eslint/no-non-null-assertion -- indices stay within the arrays' own lengths */
// Where a plane meets a triangle mesh: closed loops, and open chains that end on the mesh's rim.
import type { Place3 } from './drawn_parts';

/** The places p with normal · p = offset. */
export interface Plane {
  /** Of length 1. */
  readonly normal: Place3;
  readonly offset: number;
}

export interface Chain {
  /** x, y, z of one point on every edge that is crossed, in order; a closed one does not repeat its first. */
  readonly points: Float64Array;
  readonly closed: boolean;
  /** How many of the mesh's vertices lie along it, on the side that has fewer. */
  readonly verticesBeside: number;
  /** Mean length of the edges that it crosses. */
  readonly edgeLength: number;
}

export const distanceTo = ({ normal, offset }: Plane, at: ArrayLike<number>, from = 0): number =>
  normal[0] * at[from]! + normal[1] * at[from + 1]! + normal[2] * at[from + 2]! - offset;

/** The edges of the mesh that have one end on each side, and which of them share a triangle. */
interface Crossing {
  /** Ends of edge e: ends[2 e] above the plane, ends[2 e + 1] below it. */
  readonly ends: number[];
  /** The two edges of triangle t: sides[2 t] and sides[2 t + 1]. Only triangles that are crossed have a number. */
  readonly sides: number[];
  /** The triangles at each edge: two, and one on a rim. */
  readonly triangles: number[][];
}

/** A vertex on the plane counts as above it: so every crossed triangle has exactly two crossed edges. */
function crossing(distances: Float64Array, indices: ArrayLike<number>): Crossing {
  const [ends, sides, triangles]: [number[], number[], number[][]] = [[], [], []];
  const numbers = new Map<number, number>();
  const edge = (a: number, b: number): number => {
    const [above, below] = distances[a]! >= 0 ? [a, b] : [b, a];
    const key = above * distances.length + below;
    const known = numbers.get(key);
    if (known !== undefined) return known;
    numbers.set(key, triangles.length);
    ends.push(above, below);
    triangles.push([]);
    return triangles.length - 1;
  };
  for (let i = 0; i + 2 < indices.length; i += 3) {
    const [a, b, c] = [indices[i]!, indices[i + 1]!, indices[i + 2]!];
    const [aboveA, aboveB, aboveC] = [distances[a]! >= 0, distances[b]! >= 0, distances[c]! >= 0];
    if (aboveA === aboveB && aboveB === aboveC) continue;
    if (a === b || b === c || c === a) continue; // its two edges are one: the neighbours already meet there
    // The corner that is alone on its side.
    const [alone, one, other] = aboveB === aboveC ? [a, b, c] : aboveA === aboveC ? [b, c, a] : [c, a, b];
    const number = sides.length / 2;
    for (const end of [one, other]) {
      const crossed = edge(alone, end);
      sides.push(crossed);
      triangles[crossed]!.push(number);
    }
  }
  return { ends, sides, triangles };
}

/** Edges from `start` on, from triangle to triangle, until there is no new one. */
function walk({ sides, triangles }: Crossing, start: number, used: Uint8Array): number[] {
  const edges = [start];
  for (let at = start; ;) {
    const triangle = triangles[at]!.find((one) => used[one] === 0);
    if (triangle === undefined) return edges;
    used[triangle] = 1;
    at = sides[2 * triangle]! + sides[2 * triangle + 1]! - at;
    edges.push(at);
    if (at === start) return edges;
  }
}

function chainOf(
  edges: readonly number[],
  { ends }: Crossing,
  positions: ArrayLike<number>,
  distances: Float64Array,
): Chain {
  const closed = edges.length > 1 && edges[0] === edges.at(-1);
  const once = closed ? edges.slice(1) : edges;
  const points = new Float64Array(3 * once.length);
  const [above, below] = [new Set<number>(), new Set<number>()];
  let lengths = 0;
  once.forEach((edge, i) => {
    const [a, b] = [ends[2 * edge]!, ends[2 * edge + 1]!];
    above.add(a);
    below.add(b);
    const share = distances[a]! / (distances[a]! - distances[b]!);
    let squared = 0;
    for (let k = 0; k < 3; ++k) {
      const way = positions[3 * b + k]! - positions[3 * a + k]!;
      points[3 * i + k] = positions[3 * a + k]! + share * way;
      squared += way * way;
    }
    lengths += Math.sqrt(squared);
  });
  const verticesBeside = Math.min(above.size, below.size);
  return { points, closed, verticesBeside, edgeLength: lengths / once.length };
}

export function planeSection(
  positions: ArrayLike<number>,
  indices: ArrayLike<number>,
  plane: Plane,
): Chain[] {
  const distances = new Float64Array(Math.floor(positions.length / 3));
  for (let v = 0; v < distances.length; ++v) distances[v] = distanceTo(plane, positions, 3 * v);
  const crossed = crossing(distances, indices);
  const used = new Uint8Array(crossed.sides.length / 2);
  const chains: Chain[] = [];
  const add = (start: number) => {
    const edges = walk(crossed, start, used);
    if (edges.length > 1) chains.push(chainOf(edges, crossed, positions, distances));
  };
  // Open ones first and from their ends: what is left then comes back to where it began.
  crossed.triangles.forEach((at, edge) => (at.length % 2 === 1 ? add(edge) : undefined));
  crossed.triangles.forEach((_, edge) => add(edge));
  return chains;
}
