// SPDX-License-Identifier: GPL-3.0-or-later
// A place for the card in a corner of the window, off the control that it speaks of.

export interface Spot {
  readonly left: number;
  readonly top: number;
}

interface Box {
  readonly left: number;
  readonly top: number;
  readonly width: number;
  readonly height: number;
}

const gap_px = 12;
/** Left of it are the rooms, above it the top bar, below it the strip. */
const desk = { left: 80, top: 48, bottom: 56 };
const phone = { left: 0, top: 52, bottom: 60 };

const overlap = (a: Box, b: Box): number =>
  Math.max(0, Math.min(a.left + a.width, b.left + b.width) - Math.max(a.left, b.left)) *
  Math.max(0, Math.min(a.top + a.height, b.top + b.height) - Math.max(a.top, b.top));

/** It stays where it is as long as that is off the control. */
export function placeCard(card: HTMLElement, control: Box | null, old: Spot | null): Spot {
  const { width, height } = card.getBoundingClientRect();
  const edge = innerWidth <= 720 ? phone : desk;
  const right = innerWidth - width - gap_px;
  const bottom = innerHeight - edge.bottom - height - gap_px;
  const [left, top] = [edge.left + gap_px, edge.top + gap_px];
  const corners: Spot[] = [
    { left, top: bottom },
    { left, top },
    { left: right, top },
    { left: right, top: bottom },
  ];
  const inside = old && old.left <= right + 1 && old.top <= bottom + 1 ? [old] : [];
  const covered = (spot: Spot): number =>
    control === null ? 0 : overlap({ ...spot, width, height }, grown(control));
  const [best] = [...inside, ...corners].sort((a, b) => covered(a) - covered(b)); // a stable sort: the first of the best
  return best ?? { left, top };
}

const grown = ({ left, top, width, height }: Box): Box => ({
  left: left - gap_px,
  top: top - gap_px,
  width: width + 2 * gap_px,
  height: height + 2 * gap_px,
});
