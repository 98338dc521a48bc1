// SPDX-License-Identifier: GPL-3.0-or-later
// What a hand or a key does to one model of a group, seen along the picture's axes.
import type { PlacedModel } from '../../../shared/session/craft_document';
import type { Vector } from '../../../shared/geometry/rotation';
import type { Grip } from '../handles/grips';
import type { ViewAxes } from './placement';
import { along, turnedBy } from './placement';

const degreesAPixel = 0.5;
const turnStep_deg = 5;
const keyTurn_deg = 15;
const keyStep_mm = 5;
const keyFactor = 1.05;
const fineKeyFactor = 1.01;
const minSize_mm = 1;
export const maxSize_mm = 10_000;

const tidy = (value: number): number => Number(value.toFixed(2)) + 0;
const tidyPlace = (at: Vector): Vector => [tidy(at[0]), tidy(at[1]), tidy(at[2])];

const moved = (model: PlacedModel, ...steps: readonly (readonly [Vector, number])[]): PlacedModel => ({
  ...model,
  at_mm: tidyPlace(steps.reduce((at, [axis, by]) => along(at, axis, by), model.at_mm)),
});
const turned = (model: PlacedModel, axes: ViewAxes, by_deg: number): PlacedModel => ({
  ...model,
  turn_deg: turnedBy(model.turn_deg, axes.up, by_deg),
});
const resized = (model: PlacedModel, factor: number): PlacedModel => ({
  ...model,
  size_mm: tidy(Math.min(maxSize_mm, Math.max(minSize_mm, model.size_mm * factor))),
});

/** A pointer on its way, in the picture. */
export interface Drag {
  readonly fromPx: readonly [number, number];
  readonly toPx: readonly [number, number];
  /** Where the model's middle is seen. */
  readonly middlePx: readonly [number, number];
  /** Millimetres of the scene a pixel, at the model. */
  readonly mmAPixel: number;
}

/** `free`: turns by any angle rather than in steps of five degrees. */
export function dragged(
  model: PlacedModel,
  grip: Grip,
  drag: Drag,
  axes: ViewAxes,
  free: boolean,
): PlacedModel {
  const [dx, dy] = [drag.toPx[0] - drag.fromPx[0], drag.toPx[1] - drag.fromPx[1]];
  if (grip === 'move') return moved(model, [axes.right, dx * drag.mmAPixel], [axes.up, -dy * drag.mmAPixel]);
  if (grip === 'depth') return moved(model, [axes.away, -dy * drag.mmAPixel]);
  if (grip === 'turn') {
    const step = free ? 1 : turnStep_deg;
    return turned(model, axes, step * Math.round((dx * degreesAPixel) / step));
  }
  const distance = ([x, y]: readonly [number, number]) =>
    Math.max(4, Math.hypot(x - drag.middlePx[0], y - drag.middlePx[1]));
  return resized(model, distance(drag.toPx) / distance(drag.fromPx));
}

/** Null for keys that do nothing here. */
export function byKey(
  model: PlacedModel,
  grip: Grip,
  key: string,
  fine: boolean,
  axes: ViewAxes,
): PlacedModel | null {
  const step = fine ? 1 : keyStep_mm;
  const across = key === 'ArrowRight' ? 1 : key === 'ArrowLeft' ? -1 : 0;
  const upwards = key === 'ArrowUp' ? 1 : key === 'ArrowDown' ? -1 : 0;
  if (across === 0 && upwards === 0) return null;
  if (grip === 'move') return moved(model, [axes.right, step * across], [axes.up, step * upwards]);
  const by = across || upwards;
  if (grip === 'depth') return moved(model, [axes.away, step * by]);
  if (grip === 'turn') return turned(model, axes, (fine ? 1 : keyTurn_deg) * by);
  return resized(model, (fine ? fineKeyFactor : keyFactor) ** by);
}
