// SPDX-License-Identifier: GPL-3.0-or-later
// Reads design.json: the ribbon in space and in the plane, vertex by vertex, and what is known of its parts.

/** All vertices lie on the boundary, which is walked once with the ribbon to its left. */
export interface Ribbon {
  /** x, y, z per vertex, mm, zipped up. */
  readonly positions: Float32Array;
  /** x, y per vertex, mm, unfolded. */
  readonly flat: Float32Array;
  /** Three vertex numbers per triangle. */
  readonly triangles: Uint32Array;
  /** Of the zipper, per vertex; −1 on an opening. Two vertices with the same one meet when it is zipped. */
  readonly sample: Int32Array;
  /** Per vertex: which way along the zipper its side runs; 0 on an opening. */
  readonly side: Int8Array;
}

interface PartPlan {
  readonly period_mm: number;
  readonly height_mm: number;
  readonly windings: number;
}

export interface Design {
  /** Millimetres of the object, a unit of the model's file. */
  readonly scale: number;
  /** Parts by number, as the zipper visits them. */
  readonly order: readonly number[];
  readonly parts: readonly PartPlan[];
  readonly handlesCut: number;
  /** Middles of the openings that were punctured, mm. */
  readonly punctures: readonly (readonly [number, number, number])[];
  /** Of one side of the zipper. */
  readonly zipper_mm: number;
  /** Per sample of the zipper: how far from its start, all pieces one after the other, mm. */
  readonly along_mm: Float32Array;
  /** Per sample: which piece of the zipper it is on. */
  readonly pieceOf: Int32Array;
  readonly ribbon: Ribbon;
  /** Per triangle of the ribbon: which of two fabrics it is cut from; null where there is one. */
  readonly fabric: Uint8Array | null;
}

interface DesignFile {
  readonly format: string;
  readonly scale: number;
  readonly order: number[];
  readonly parts: PartPlan[];
  readonly handles_cut: number;
  readonly punctures: { readonly position_mm: [number, number, number] }[];
  readonly zipper_mm: number;
  readonly pieces: number[][];
  readonly ribbon: {
    readonly boundary: {
      readonly position_mm: number[];
      readonly flat_mm: number[];
      readonly zipper_sample: number;
      readonly side: string;
    }[];
    readonly triangles: number[][];
    readonly fabric?: number[];
  };
}

const sides: Readonly<Record<string, number>> = { left: 1, right: -1, opening: 0 };

/** Throws Error with one sentence for what is no such file. */
export function readDesign(bytes: Uint8Array): Design {
  const file = JSON.parse(new TextDecoder().decode(bytes)) as Partial<DesignFile>;
  if (file.format !== 'formwright zippable design' || !file.ribbon || !file.parts || !file.pieces)
    throw new Error('The design cannot be read: it is not a zippable’s design.json.');
  const { boundary, triangles } = file.ribbon;
  const ribbon: Ribbon = {
    positions: Float32Array.from(boundary.flatMap(({ position_mm }) => position_mm)),
    flat: Float32Array.from(boundary.flatMap(({ flat_mm }) => flat_mm)),
    triangles: Uint32Array.from(triangles.flat()),
    sample: Int32Array.from(boundary, ({ zipper_sample }) => zipper_sample),
    side: Int8Array.from(boundary, ({ side }) => sides[side] ?? 0),
  };
  const samples = 1 + ribbon.sample.reduce((most, sample) => Math.max(most, sample), -1);
  const pieceOf = new Int32Array(samples).fill(-1);
  file.pieces.forEach((piece, index) => piece.forEach((sample) => (pieceOf[sample] = index)));
  return {
    scale: file.scale ?? 1,
    order: file.order ?? [],
    parts: file.parts,
    handlesCut: file.handles_cut ?? 0,
    punctures: (file.punctures ?? []).map(({ position_mm }) => position_mm),
    zipper_mm: file.zipper_mm ?? 0,
    along_mm: alongZipper(ribbon, file.pieces, samples),
    pieceOf,
    ribbon,
    fabric: file.ribbon.fabric ? Uint8Array.from(file.ribbon.fabric) : null,
  };
}

function alongZipper(ribbon: Ribbon, pieces: readonly number[][], samples: number): Float32Array {
  const vertexOf = new Int32Array(samples).fill(-1);
  ribbon.sample.forEach((sample, vertex) => {
    if (sample >= 0) vertexOf[sample] = vertex;
  });
  const along_mm = new Float32Array(samples);
  let total = 0;
  for (const piece of pieces)
    piece.forEach((sample, i) => {
      const before = i > 0 ? (vertexOf[piece[i - 1] ?? 0] ?? -1) : -1;
      const here = vertexOf[sample] ?? -1;
      if (before >= 0 && here >= 0) total += distanceBetween(ribbon.positions, before, here);
      along_mm[sample] = total;
    });
  return along_mm;
}

function distanceBetween(positions: Float32Array, a: number, b: number): number {
  return Math.hypot(...[0, 1, 2].map((k) => (positions[3 * a + k] ?? 0) - (positions[3 * b + k] ?? 0)));
}

/** Whether the boundary runs along the zipper from one vertex to the next, or along an opening. */
function isZipperEdge({ ribbon, pieceOf }: Design, a: number, b: number): boolean {
  const [from, to] = [ribbon.sample[a] ?? -1, ribbon.sample[b] ?? -1];
  return from >= 0 && to >= 0 && ribbon.side[a] === ribbon.side[b] && pieceOf[from] === pieceOf[to];
}

/** The boundary's edges of one kind, as vertex numbers two by two. */
export function boundaryEdges(design: Design, kind: 'zipper' | 'opening'): Uint32Array {
  const count = design.ribbon.sample.length;
  const edges: number[] = [];
  for (let a = 0; a < count; ++a) {
    const b = (a + 1) % count;
    if (isZipperEdge(design, a, b) === (kind === 'zipper')) edges.push(a, b);
  }
  return Uint32Array.from(edges);
}

/** Parts as a maker counts them, and as the core's sentences do. */
export const partName = (part: number): string => `Part ${part + 1}`;
