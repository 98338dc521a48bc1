// SPDX-License-Identifier: GPL-3.0-or-later
// How the model stands in the machine (millimetres, z up, origin in the centre of the clamp's opening). The
// core decides; while a parameter is dragged, what it said last is carried on to the new values here.
import type { JsonObject, Report } from '../../jobs/contract';

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

/** The longest side of a model that was not turned yet, as the parameter `size_mm` counts it. `box`: in the model's coordinates. */
export function sizeBeforeTurning_mm(m: Placement, { low, high }: Box): number {
  const scale = Math.hypot(m[0] ?? 0, m[1] ?? 0, m[2] ?? 0);
  return scale * Math.max(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
}

/** By how much a model must shrink to stand in the middle of the opening with 5 mm around it; 1: not at all. */
export function shareThatFits({ low, high }: Box, opening_mm: readonly [number, number]): number {
  const margin_mm = 5;
  const fits = (axis: 0 | 1) => (opening_mm[axis] - 2 * margin_mm) / (high[axis] - low[axis]);
  return Math.min(1, fits(0), fits(1));
}

const number = (values: JsonObject, name: string): number => Number(values[name] ?? 0);

/** Where the core will put the model with the parameters `to`, given where it stood with `from`; null where
 *  that takes the core itself (another up, an automatic size). Shifts, sink, turn and sizes are exact. */
export function carriedOn(
  m: Placement,
  from: JsonObject,
  to: JsonObject,
  positions: ArrayLike<number>,
): Placement | null {
  if (JSON.stringify(from['up']) !== JSON.stringify(to['up'])) return null;
  const [size, wanted] = [from['size_mm'] ?? null, to['size_mm'] ?? null];
  if (size !== wanted && (typeof size !== 'number' || typeof wanted !== 'number')) return null;
  const factor = typeof size === 'number' && typeof wanted === 'number' ? wanted / size : 1;
  const turn = ((number(to, 'turn_deg') - number(from, 'turn_deg')) * Math.PI) / 180;
  const moved = [...m];
  if (factor === 1 && turn === 0) {
    moved[3] = (m[3] ?? 0) + number(to, 'x_mm') - number(from, 'x_mm');
    moved[7] = (m[7] ?? 0) + number(to, 'y_mm') - number(from, 'y_mm');
    moved[11] = (m[11] ?? 0) - number(to, 'sink_mm') + number(from, 'sink_mm');
    return moved;
  }
  const [c, s] = [factor * Math.cos(turn), factor * Math.sin(turn)];
  for (let j = 0; j < 3; ++j) {
    const [x, y, z] = [m[j] ?? 0, m[4 + j] ?? 0, m[8 + j] ?? 0];
    [moved[j], moved[4 + j], moved[8 + j]] = [c * x - s * y, s * x + c * y, factor * z];
  }
  moved[3] = moved[7] = moved[11] = 0;
  const { low, high } = boxOf(placed(positions, moved));
  moved[3] = number(to, 'x_mm') - (low[0] + high[0]) / 2;
  moved[7] = number(to, 'y_mm') - (low[1] + high[1]) / 2;
  moved[11] = -low[2] - number(to, 'sink_mm');
  return moved;
}

/** How far a model reaches beyond the clamp's opening, mm; 0 inside. */
export function beyondOpening(box: Box, opening_mm: readonly [number, number]): number {
  const over = ([0, 1] as const).map((axis) =>
    Math.max(box.high[axis] - opening_mm[axis] / 2, -opening_mm[axis] / 2 - box.low[axis]),
  );
  return Math.max(0, ...over);
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
