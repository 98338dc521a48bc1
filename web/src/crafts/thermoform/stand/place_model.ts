// SPDX-License-Identifier: GPL-3.0-or-later
// Where the core puts a model with given parameters (`core/thermoform/sheet/placement.cpp`), so that the picture
// follows the hand before the core has answered. A test compares both.
import type { JsonObject } from '../../../jobs/contract';
import type { Rotation, Vector } from '../../../shared/geometry/rotation';
import type { Stance } from './stance';
import { rotationOf, stanceOf, standing } from './stance';

/** Between the model and the clamp's edge. */
export const margin_mm = 5;

/** As the core's automatic size: a file's own size above 10 mm that leaves the margin, else 100 mm or what leaves it. */
const automatic = { min_mm: 10, usual_mm: 100 } as const;

export interface Placed {
  /** mm for each unit of the file. */
  readonly scale: number;
  /** 4 x 4, row by row, as the core reports it. */
  readonly matrix: readonly number[];
  /** The longest side before turning, in the file's units. */
  readonly extent: number;
}

const number = (values: JsonObject, name: string): number => Number(values[name] ?? 0);

function stanceIn(values: JsonObject): Stance {
  const up = values['up'];
  return {
    up: (Array.isArray(up) && up.length === 3 ? up.map(Number) : [0, 1, 0]) as unknown as Vector,
    turn_deg: number(values, 'turn_deg'),
  };
}

interface Extremes {
  readonly low: Vector;
  readonly high: Vector;
}

/** Of the rotations asked for last: while a model is dragged, the same ones are asked for again and again. */
const known = new WeakMap<object, Map<string, Extremes>>();
const maxKnown = 8;

function extremes(positions: ArrayLike<number>, r: Rotation): Extremes {
  const ofMesh = known.get(positions) ?? new Map<string, Extremes>();
  known.set(positions, ofMesh);
  const key = r.join();
  const found = ofMesh.get(key) ?? findExtremes(positions, r);
  ofMesh.delete(key);
  ofMesh.set(key, found); // the newest last
  for (const old of ofMesh.keys()) {
    if (ofMesh.size <= maxKnown) break;
    ofMesh.delete(old);
  }
  return found;
}

function findExtremes(positions: ArrayLike<number>, r: Rotation): Extremes {
  const low: [number, number, number] = [Infinity, Infinity, Infinity];
  const high: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i + 2 < positions.length; i += 3) {
    const [x = 0, y = 0, z = 0] = [positions[i], positions[i + 1], positions[i + 2]];
    for (let k = 0; k < 3; ++k) {
      const value = (r[3 * k] ?? 0) * x + (r[3 * k + 1] ?? 0) * y + (r[3 * k + 2] ?? 0) * z;
      if (value < (low[k] ?? 0)) low[k] = value;
      if (value > (high[k] ?? 0)) high[k] = value;
    }
  }
  return { low, high };
}

/** `values`: all that the placement depends on, defaults included. Null where the core refuses. */
export function placeModel(values: JsonObject, positions: ArrayLike<number>): Placed | null {
  const stance = stanceIn(values);
  const [upright, rotation] = [standing(stance.up), rotationOf(stance)];
  if (upright === null || rotation === null) return null;
  const straight = extremes(positions, upright);
  const sizes = straight.high.map((value, k) => value - (straight.low[k] ?? 0)) as unknown as Vector;
  const extent = Math.max(...sizes);
  if (!(extent > 0) || !Number.isFinite(extent)) return null;
  const { low, high } = stance.turn_deg === 0 ? straight : extremes(positions, rotation);
  const scale = scaleOf(values, extent, sizes);
  const shift: Vector = [
    number(values, 'x_mm') - (scale * (low[0] + high[0])) / 2,
    number(values, 'y_mm') - (scale * (low[1] + high[1])) / 2,
    -scale * low[2] - number(values, 'sink_mm'),
  ];
  const rows = [0, 1, 2].flatMap((k) => [
    ...rotation.slice(3 * k, 3 * k + 3).map((value) => scale * value),
    shift[k as 0 | 1 | 2],
  ]);
  return { scale, extent, matrix: [...rows, 0, 0, 0, 1] };
}

function scaleOf(values: JsonObject, extent: number, [x, y]: Vector): number {
  const size_mm = values['size_mm'] ?? null;
  if (size_mm !== null) return Number(size_mm) / extent;
  const room = (name: string) => {
    const opening_mm = number(values, name);
    return Math.max(opening_mm - 2 * margin_mm, 0.1 * opening_mm);
  };
  const fits = Math.min(room('clamp_opening_x_mm') / x, room('clamp_opening_y_mm') / y);
  return extent < automatic.min_mm || fits < 1 ? Math.min(automatic.usual_mm / extent, fits) : 1;
}

/** The parameters that stand a model otherwise and keep it as large as it is. An automatic size stays automatic where
 *  the core chooses the same one again. Null where the core refuses. */
export function stoodOtherwise(
  values: JsonObject,
  positions: ArrayLike<number>,
  rotation: Rotation,
): JsonObject | null {
  const { up, turn_deg } = stanceOf(rotation);
  const changed: JsonObject = { up: [...up], turn_deg };
  const before = placeModel(values, positions);
  const now = placeModel({ ...values, ...changed }, positions);
  if (before === null || now === null) return null;
  if (Math.abs(now.scale / before.scale - 1) < 1e-9) return changed;
  return { ...changed, size_mm: Number((before.scale * now.extent).toFixed(2)) };
}

/** The turn of the placement in force. */
export const rotationIn = (values: JsonObject): Rotation | null => rotationOf(stanceIn(values));

/** The normal of the side that lies on the plate, in the model's axes. */
export const undersideIn = (values: JsonObject): Vector | null => {
  const rotation = rotationIn(values);
  return rotation && ([-rotation[6], -rotation[7], -rotation[8]] as const);
};

/** Machine coordinates of a point of the model. */
export function pointAt(matrix: readonly number[], p: Vector): Vector {
  const at = (k: number) => {
    const [a = 0, b = 0, c = 0, t = 0] = matrix.slice(4 * k, 4 * k + 4);
    return a * p[0] + b * p[1] + c * p[2] + t;
  };
  return [at(0), at(1), at(2)];
}
