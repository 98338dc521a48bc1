// SPDX-License-Identifier: GPL-3.0-or-later
// What handles in the picture are called, and where they stand around the middle of what they move.

export type Grip = 'move' | 'depth' | 'turn' | 'size';
/** In the picture, px. */
export type Place = readonly [x: number, y: number];

/** Their buttons over the picture. */
export type GripElements = Partial<Record<Grip, HTMLElement | null>>;

/** Of the handles about the middle: none covers another, and none goes under what floats at the view's border. */
const minRadiusPx = 44;
const maxRadiusPx = 120;

/** Puts them around the middle as far away as half of what they move is seen; hides them where it is not. */
export function placeAround(
  elements: GripElements,
  grips: readonly Grip[],
  middlePx: Place | null,
  halfSizePx: number,
): void {
  const radius = Math.min(maxRadiusPx, Math.max(minRadiusPx, halfSizePx));
  const diagonal = radius * Math.SQRT1_2;
  const offsets: Readonly<Record<Grip, Place>> = {
    move: [0, 0],
    depth: [0, -radius],
    turn: [radius, 0],
    size: [diagonal, diagonal],
  };
  for (const grip of grips) {
    const element = elements[grip];
    if (!element) continue;
    element.hidden = middlePx === null;
    if (middlePx === null) continue;
    const [x, y] = [middlePx[0] + offsets[grip][0], middlePx[1] + offsets[grip][1]];
    element.style.translate = `${x.toFixed(1)}px ${y.toFixed(1)}px`;
  }
}
