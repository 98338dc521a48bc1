// SPDX-License-Identifier: GPL-3.0-or-later
// The part of the floor that is drawn, and where an eye beyond it is marked. Drawings have y downwards.
import type { Place, Scene, Viewpoint } from '../scene';
import { isShaped, placeOf, widthOf } from '../scene';

export interface Frame {
  readonly left: number;
  readonly top: number;
  readonly width: number;
  readonly height: number;
}

/** It grows by steps, so that what is dragged does not move the rest with it. */
const step_mm = 40;
const margin_mm = 24;
/** So that the floor around a single pillar is seen, too. */
const min_size_mm = 160;

/** Around pillars and what is looked at; with `eyes`, around these, too. */
export function frameOf({ viewpoints, pillars }: Scene, eyes: boolean): Frame {
  const places: Place[] = viewpoints.flatMap(({ look_at_mm: [x, y], eye_mm }) => [
    [x, y] as const,
    ...(eyes ? [[eye_mm[0], eye_mm[1]] as const] : []),
  ]);
  for (const pillar of pillars) {
    const [x, y] = placeOf(pillar);
    const half = 0.5 * widthOf(pillar);
    if (isShaped(pillar)) places.push([x - half, y - half], [x + half, y + half]);
    else places.push(...pillar.outline_mm);
  }
  if (places.length === 0) places.push([0, 0]);
  const span = (k: 0 | 1): readonly [number, number] => {
    const all = places.map((place) => place[k]);
    const low = Math.floor((Math.min(...all) - margin_mm) / step_mm) * step_mm;
    const high = Math.ceil((Math.max(...all) + margin_mm) / step_mm) * step_mm;
    const more = Math.max(0, min_size_mm - (high - low)) / 2;
    return [low - more, high + more];
  };
  const [x, y] = [span(0), span(1)];
  return { left: x[0], top: -y[1], width: x[1] - x[0], height: y[1] - y[0] };
}

export interface EyeMark {
  readonly place: Place;
  /** The eye itself is farther away in this direction. */
  readonly beyond: boolean;
}

/** The eye, or where its line of sight enters the frame, `inset_mm` from the border. */
export function markOf(
  { eye_mm, look_at_mm }: Viewpoint,
  { left, top, width, height }: Frame,
  inset_mm: number,
): EyeMark {
  const low = [left + inset_mm, -(top + height) + inset_mm];
  const high = [left + width - inset_mm, -top - inset_mm];
  let share = 1;
  for (const k of [0, 1]) {
    const [from, to] = [look_at_mm[k] ?? 0, eye_mm[k] ?? 0];
    const border = to > from ? (high[k] ?? 0) : (low[k] ?? 0);
    const inside = to > from ? to <= border : to >= border;
    if (!inside) share = Math.min(share, Math.max(0, (border - from) / (to - from)));
  }
  const at = (k: 0 | 1) => look_at_mm[k] + share * (eye_mm[k] - look_at_mm[k]);
  return { place: [at(0), at(1)], beyond: share < 1 };
}
