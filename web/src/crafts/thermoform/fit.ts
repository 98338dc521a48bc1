// SPDX-License-Identifier: GPL-3.0-or-later
// The room that a clamp leaves to a model, and what to change so that the model keeps 5 mm from its edge.
import type { JsonObject } from '../../jobs/contract';
import { boxOf, placed, shareThatFits } from './placement';
import { placeModel } from './stand/place_model';

/** The opening, less the rim of the sheet that may slip out of the clamp. */
export function roomIn(values: JsonObject): readonly [number, number] {
  const side = (name: string) => Number(values[name] ?? 0) - 2 * Number(values['clamp_slip_mm'] ?? 0);
  return [side('clamp_opening_x_mm'), side('clamp_opening_y_mm')];
}

/** The parameters that move a model to the middle and, where that is not enough, make it as large as fits. Null where
 *  the core refuses. */
export function fitting(values: JsonObject, positions: ArrayLike<number>): JsonObject | null {
  const now = placeModel(values, positions);
  if (now === null) return null;
  const share = shareThatFits(boxOf(placed(positions, now.matrix)), roomIn(values));
  const fitted = share * now.scale * now.extent;
  // Whole millimetres where there are many.
  const size_mm = fitted >= 10 ? Math.floor(fitted) : Math.floor(10 * fitted) / 10;
  return { x_mm: 0, y_mm: 0, ...(share < 1 ? { size_mm } : {}) };
}
