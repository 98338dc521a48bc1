// SPDX-License-Identifier: GPL-3.0-or-later
// How the model stands in the machine (millimetres, z up, origin in the centre of the clamp's opening). The
// core decides; while a parameter is dragged, what it said last is carried on to the new values here.
import type { JsonObject, Report } from '../../jobs/contract';
import type { Placed } from './stand/place_model';
import { margin_mm, placeModel } from './stand/place_model';

/** 4 x 4, row by row: from the model's coordinates to the machine's. */
export type Placement = readonly number[];
type Corner = readonly [number, number, number];

export interface Box {
  readonly low: Corner;
  readonly high: Corner;
}

export function placementOf(report: Report): Placement | null {
  const value = report['placement'];
  const all = Array.isArray(value) && value.length === 16 && value.every((x) => typeof x === 'number');
  return all ? (value as number[]) : null;
}

export function placed(positions: ArrayLike<number>, m: Placement): Float32Array<ArrayBuffer> {
  const [a = 1, b = 0, c = 0, tx = 0, d = 0, e = 1, f = 0, ty = 0, g = 0, h = 0, i = 1, tz = 0] = m;
  const out = new Float32Array(positions.length);
  for (let k = 0; k + 2 < positions.length; k += 3) {
    const [x = 0, y = 0, z = 0] = [positions[k], positions[k + 1], positions[k + 2]];
    out[k] = a * x + b * y + c * z + tx;
    out[k + 1] = d * x + e * y + f * z + ty;
    out[k + 2] = g * x + h * y + i * z + tz;
  }
  return out;
}

/** The turn without the scale, 3 x 3 row by row. */
export function rotationOf(m: Placement): number[] {
  const rows = [0, 4, 8].flatMap((at) => [m[at] ?? 0, m[at + 1] ?? 0, m[at + 2] ?? 0]);
  const scale = Math.hypot(...rows.slice(0, 3)) || 1;
  return rows.map((value) => value / scale);
}

export function boxOf(positions: ArrayLike<number>): Box {
  const low: [number, number, number] = [Infinity, Infinity, Infinity];
  const high: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  for (let k = 0; k < positions.length; ++k) {
    const axis = (k % 3) as 0 | 1 | 2;
    const x = positions[k] ?? 0;
    if (x < low[axis]) low[axis] = x;
    if (x > high[axis]) high[axis] = x;
  }
  return { low, high };
}

/** By how much a model must shrink to stand in the middle of the opening with a margin around it; 1: not at all. */
export function shareThatFits({ low, high }: Box, opening_mm: readonly [number, number]): number {
  const fits = (axis: 0 | 1) => (opening_mm[axis] - 2 * margin_mm) / (high[axis] - low[axis]);
  return Math.min(1, fits(0), fits(1));
}

const number = (values: JsonObject, name: string): number => Number(values[name] ?? 0);

/** All that decides how a model is turned and how large it is. */
const turnAndSize = ['up', 'turn_deg', 'size_mm', 'clamp_opening_x_mm', 'clamp_opening_y_mm'];

/** Where the core will put the model with the parameters `to`, given where it stood with `from`, defaults included;
 *  null where the core refuses. */
export function carriedOn(
  m: Placement,
  from: JsonObject,
  to: JsonObject,
  positions: ArrayLike<number>,
): Placement | null {
  if (turnAndSize.every((name) => JSON.stringify(from[name]) === JSON.stringify(to[name]))) {
    const moved = [...m];
    moved[3] = (m[3] ?? 0) + number(to, 'x_mm') - number(from, 'x_mm');
    moved[7] = (m[7] ?? 0) + number(to, 'y_mm') - number(from, 'y_mm');
    moved[11] = (m[11] ?? 0) - number(to, 'sink_mm') + number(from, 'sink_mm');
    return moved;
  }
  const [before, after] = [placeModel(from, positions), placeModel(to, positions)];
  return before && after && displacedAlike(m, before, after);
}

/** `after`, displaced as the core displaced `before` to `m`: a profile says how this machine misplaces models. */
function displacedAlike(m: Placement, before: Placed, after: Placed): Placement {
  const out = [...after.matrix];
  const at = (matrix: readonly number[], i: number, j: number): number => matrix[4 * i + j] ?? 0;
  for (let i = 0; i < 3; ++i) {
    // A row of m's turn and scale, times the inverse of before's.
    const displacement = [0, 1, 2].map(
      (j) => [0, 1, 2].reduce((sum, k) => sum + at(m, i, k) * at(before.matrix, j, k), 0) / before.scale ** 2,
    );
    const through = (matrix: readonly number[], j: number): number =>
      displacement.reduce((sum, value, k) => sum + value * at(matrix, k, j), 0);
    for (let j = 0; j < 4; ++j) out[4 * i + j] = through(after.matrix, j);
    out[4 * i + 3] = (out[4 * i + 3] ?? 0) + at(m, i, 3) - through(before.matrix, 3);
  }
  return out;
}

/** The least distance of a model from the edge of the clamp's opening, mm; negative where it reaches beyond. */
export function clearance_mm({ low, high }: Box, opening_mm: readonly [number, number]): number {
  const to = (axis: 0 | 1) => opening_mm[axis] / 2 - Math.max(high[axis], -low[axis]);
  return Math.min(to(0), to(1));
}

export interface Ray {
  readonly originMm: Corner;
  readonly direction: Corner;
}

/** Where a ray of sight meets the height `z_mm`; null where it runs along or away. */
export function onLevel({ originMm, direction }: Ray, z_mm: number): readonly [number, number] | null {
  const t = (z_mm - originMm[2]) / direction[2];
  if (!(t > 0) || !Number.isFinite(t)) return null;
  return [originMm[0] + t * direction[0], originMm[1] + t * direction[1]];
}
