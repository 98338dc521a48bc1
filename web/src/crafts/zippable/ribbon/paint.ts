// SPDX-License-Identifier: GPL-3.0-or-later
// What the ribbon is painted in: each part in its own colour, or both fabrics in theirs.
import type { Design } from '../design';
import { colourToken } from '../../../shared/panels/colour_token';
import type { RibbonPieces } from './cut_ribbon';

/** Triangles that are painted alike. */
export interface Paint {
  readonly part: number;
  /** The style sheet's name of the colour. */
  readonly token: string;
}

export interface Painted {
  /** By piece of the ribbon. */
  readonly ofPiece: Int32Array;
  readonly paints: readonly Paint[];
}

const fabrics = 2;
/** Fabrics as a maker counts them, and as the plan's sheets name them. */
export const fabricName = (fabric: number): string => `Colour ${fabric + 1}`;
export const fabricToken = (fabric: number): string => colourToken(fabric);

export const paintsOfParts = (count: number): Paint[] =>
  Array.from({ length: count }, (_, part) => ({ part, token: colourToken(part) }));

export function paintedRibbon(
  { parts, fabric }: Design,
  { part, of }: Pick<RibbonPieces, 'part' | 'of'>,
): Painted {
  if (fabric === null) return { ofPiece: part, paints: paintsOfParts(parts.length) };
  return {
    ofPiece: part.map((own, i) => fabrics * own + (fabric[of[i] ?? 0] ?? 0)),
    paints: Array.from({ length: fabrics * parts.length }, (_, i) => ({
      part: Math.floor(i / fabrics),
      token: fabricToken(i % fabrics),
    })),
  };
}
