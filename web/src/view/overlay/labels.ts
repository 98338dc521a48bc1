// SPDX-License-Identifier: GPL-3.0-or-later
// Which labels can be read where several lie over each other.
import type { Point } from './dimensions';

export interface Label {
  /** Of the mark that it belongs to; null where that is not in view. */
  readonly at: Point | null;
  readonly text: string;
}

/** As `.fw-marker span` has them: to the right of the mark, and how long about an em of small text is, px. */
const left_px = 8;
const height_px = 24;
const letter_px = 8;
const padding_px = 14;

interface Box {
  readonly left: number;
  readonly top: number;
  readonly right: number;
  readonly bottom: number;
}

function boxOf({ at, text }: Label): Box | null {
  if (at === null || text === '') return null;
  const left = at.xPx + left_px;
  const top = at.yPx - 0.5 * height_px;
  return { left, top, right: left + padding_px + letter_px * text.length, bottom: top + height_px };
}

const meet = (a: Box, b: Box): boolean =>
  a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

/** Of each label whether it is shown: it lies over none that is shown before it. */
export function readable(labels: readonly Label[]): boolean[] {
  const shown: Box[] = [];
  return labels.map((label) => {
    const box = boxOf(label);
    if (box === null || shown.some((other) => meet(box, other))) return false;
    shown.push(box);
    return true;
  });
}
