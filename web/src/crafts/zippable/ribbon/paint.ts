// SPDX-License-Identifier: GPL-3.0-or-later
// What the ribbon is painted in: each part in its own colour, or both fabrics in theirs.
import type { Design } from '../design';
import { partToken } from '../views';

/** Triangles that are painted alike. */
export interface Paint {
  readonly part: number;
  /** The style sheet's name of the colour. */
  readonly token: string;
}

export interface Painted {
  readonly ofTriangle: Int32Array;
  readonly paints: readonly Paint[];
}

const fabrics = 2;
/** Fabrics as a maker counts them, and as the plan's sheets name them. */
export const fabricName = (fabric: number): string => `Colour ${fabric + 1}`;
export const fabricToken = (fabric: number): string => partToken(fabric);

export const paintsOfParts = (count: number): Paint[] =>
  Array.from({ length: count }, (_, part) => ({ part, token: partToken(part) }));

export function paintedRibbon({ parts, fabric }: Design, partOfTriangle: Int32Array): Painted {
  if (fabric === null) return { ofTriangle: partOfTriangle, paints: paintsOfParts(parts.length) };
  return {
    ofTriangle: partOfTriangle.map((part, t) => fabrics * part + (fabric[t] ?? 0)),
    paints: Array.from({ length: fabrics * parts.length }, (_, i) => ({
      part: Math.floor(i / fabrics),
      token: fabricToken(i % fabrics),
    })),
  };
}
