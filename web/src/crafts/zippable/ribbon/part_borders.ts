// SPDX-License-Identifier: GPL-3.0-or-later
/* eslint-disable @typescript-eslint/no-non-null-assertion -- indices stay within the arrays' own lengths */
// How deep inside a part a place is: the distance from the border to the neighbours, as the parameterised model has it.
import type { ParameterisedMesh } from './part_map';
import { VertexGrid } from './part_map';

type Point = readonly [number, number, number];

/** From a border that a part does not have. */
const farAway_mm = 1e6;

interface Border {
  readonly grid: VertexGrid;
  /** Start x, y, z and end x, y, z of each edge at a vertex of the grid. */
  readonly edgesAt: readonly (readonly (readonly number[])[])[];
}

const pairOf = (a: number, b: number): string => `${Math.min(a, b)} ${Math.max(a, b)}`;

/** Edges that triangles of two parts share, by part and by pair; where they meet vertices are apart, at the same place. */
function edgesBetweenParts({ positions, indices, attributes }: ParameterisedMesh): Map<string, number[][]> {
  const segment = attributes['segment'] ?? new Float32Array(0);
  const place = (v: number) => `${positions[3 * v]},${positions[3 * v + 1]},${positions[3 * v + 2]}`;
  const places = new Map<string, number>();
  const number = Int32Array.from(segment, (_, v) => {
    const key = place(v);
    const known = places.get(key) ?? places.size;
    places.set(key, known);
    return known;
  });
  const seen = new Map<number, number>();
  const edges = new Map<string, number[][]>();
  for (let at = 0; at < indices.length; ++at) {
    const [a, b] = [indices[at]!, indices[at % 3 === 2 ? at - 2 : at + 1]!];
    const [i, j] = [number[a]!, number[b]!];
    const key = Math.min(i, j) * places.size + Math.max(i, j);
    const part = segment[a]!;
    const other = seen.get(key) ?? part;
    seen.set(key, part);
    if (other === part) continue;
    const edge = [...positions.subarray(3 * a, 3 * a + 3), ...positions.subarray(3 * b, 3 * b + 3)];
    for (const owner of [String(part), String(other), pairOf(part, other)]) {
      const own = edges.get(owner);
      if (own) own.push(edge);
      else edges.set(owner, [edge]);
    }
  }
  return edges;
}

function borderOf(edges: readonly number[][]): Border {
  const at = new Map<string, number>();
  const ends: number[] = [];
  const edgesAt: number[][][] = [];
  for (const edge of edges)
    for (const end of [edge.slice(0, 3), edge.slice(3)]) {
      const key = end.join();
      let known = at.get(key);
      if (known === undefined) {
        at.set(key, (known = edgesAt.length));
        ends.push(...end);
        edgesAt.push([]);
      }
      edgesAt[known]!.push(edge);
    }
  return { grid: new VertexGrid(Float32Array.from(ends)), edgesAt };
}

function distanceToEdge(point: Point, edge: readonly number[]): number {
  let [along, squared] = [0, 0];
  for (let k = 0; k < 3; ++k) {
    const side = edge[3 + k]! - edge[k]!;
    along += side * (point[k]! - edge[k]!);
    squared += side * side;
  }
  const share = squared > 0 ? Math.min(1, Math.max(0, along / squared)) : 0;
  return Math.hypot(...[0, 1, 2].map((k) => point[k]! - edge[k]! - share * (edge[3 + k]! - edge[k]!)));
}

function distanceTo({ grid, edgesAt }: Border, point: Point): number {
  const near = edgesAt[grid.nearest(point)] ?? [];
  return Math.min(...near.map((edge) => distanceToEdge(point, edge)));
}

export class PartBorders {
  readonly #mesh: ParameterisedMesh;
  readonly #vertices: VertexGrid;
  readonly #borders = new Map<string, Border>();

  constructor(mesh: ParameterisedMesh, vertices: VertexGrid) {
    this.#mesh = mesh;
    this.#vertices = vertices;
    for (const [owner, edges] of edgesBetweenParts(mesh)) this.#borders.set(owner, borderOf(edges));
  }

  /** The part of the nearest vertex. */
  partAt(point: Point): number {
    return this.#mesh.attributes['segment']?.[this.#vertices.nearest(point)] ?? 0;
  }

  /** How much deeper a place is in `part` than in `other`, mm: twice its distance from the border that they share. In a third
   *  part, or where they share none, by the distances from both. */
  deeper(point: Point, part: number, other: number, inside: number): number {
    const shared = this.#borders.get(pairOf(part, other));
    if (shared && (inside === part || inside === other))
      return (inside === part ? 2 : -2) * distanceTo(shared, point);
    return this.#depth(point, part, inside) - this.#depth(point, other, inside);
  }

  /** Distance from the border of `part`, mm; negative outside. */
  #depth(point: Point, part: number, inside: number): number {
    const border = this.#borders.get(String(part));
    const distance = border ? distanceTo(border, point) : farAway_mm;
    return part === inside ? distance : -distance;
  }
}
