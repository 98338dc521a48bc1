// SPDX-License-Identifier: GPL-3.0-or-later
// Handles belong on the rings around a model. Where that is small on the screen they would lie over it and each other.
import type { Viewport } from '../../../view';
import { narrow } from '../../../shared/panels/narrow';
import type { Box } from '../placement';

interface Point {
  readonly xPx: number;
  readonly yPx: number;
}

/** From the middle of the model to the middle of a handle: so neighbouring handles stay apart. */
const minAway_px = () => (narrow() ? 60 : 48);

/** `at`, or as far from `middle` in the same direction as `min_px`. */
export function clearOf(middle: Point, at: Point, min_px: number): Point {
  const [x, y] = [at.xPx - middle.xPx, at.yPx - middle.yPx];
  const away = Math.hypot(x, y);
  if (away >= min_px || away < 1) return at;
  const farther = min_px / away;
  return { xPx: middle.xPx + farther * x, yPx: middle.yPx + farther * y };
}

/** Where a handle is drawn that belongs at a point of the screen, beside a model that stands in `box`. */
export function besideModel(viewport: Viewport, { low, high }: Box, at: Point): Point {
  const middle = viewport.project([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2]);
  return middle ? clearOf(middle, at, minAway_px()) : at;
}
