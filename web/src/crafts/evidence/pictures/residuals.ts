// SPDX-License-Identifier: GPL-3.0-or-later
// Measured points beside simulated ones, as residuals.csv has them, and what charts and maps show of them.
// A difference goes from the measured to the simulated place.

export interface Residuals {
  readonly count: number;
  /** x, y on the flat sheet, mm. */
  readonly sheet: Float64Array;
  /** x, y, z, mm. */
  readonly measured: Float64Array;
  readonly base: Float64Array;
  readonly extended: Float64Array | null;
}

export type Model = 'base' | 'extended';

const xyz = ['x_mm', 'y_mm', 'z_mm'] as const;

/** By object; a table without objects is known by the empty name. Throws Error where columns are missing. */
export function readResiduals(csv: string): Map<string, Residuals> {
  const [header = '', ...lines] = csv.split(/\r?\n/).filter((line) => line !== '');
  const names = header.split(',');
  const columns = (prefix: string): number[] => xyz.map((name) => names.indexOf(prefix + name));
  const sheet = ['sheet_x_mm', 'sheet_y_mm'].map((name) => names.indexOf(name));
  const measured = columns('');
  const base = columns(names.includes('calibrated_x_mm') ? 'calibrated_' : 'simulated_');
  const extended = names.includes('extended_x_mm') ? columns('extended_') : null;
  if ([...sheet, ...measured, ...base, ...(extended ?? [])].some((column) => column < 0))
    throw new Error('The file residuals.csv lacks columns: run the diagnosis again.');
  const object = names.indexOf('object');
  const rows = new Map<string, string[][]>();
  for (const line of lines) {
    const fields = line.split(',');
    const name = object < 0 ? '' : (fields[object] ?? '');
    const own = rows.get(name);
    if (own) own.push(fields);
    else rows.set(name, [fields]);
  }
  const pick = (own: string[][], wanted: number[]): Float64Array =>
    Float64Array.from(own.flatMap((fields) => wanted.map((column) => Number(fields[column]))));
  return new Map(
    [...rows].map(([name, own]) => [
      name,
      {
        count: own.length,
        sheet: pick(own, sheet),
        measured: pick(own, measured),
        base: pick(own, base),
        extended: extended && pick(own, extended),
      },
    ]),
  );
}

export const simulatedIn = (residuals: Residuals, model: Model): Float64Array =>
  (model === 'extended' ? residuals.extended : null) ?? residuals.base;

/** Distance between measured and simulated, mm. */
export function distancesOf(residuals: Residuals, model: Model): Float64Array {
  const simulated = simulatedIn(residuals, model);
  return Float64Array.from({ length: residuals.count }, (_, i) =>
    Math.hypot(...[0, 1, 2].map((k) => (simulated[3 * i + k] ?? 0) - (residuals.measured[3 * i + k] ?? 0))),
  );
}

/** How much higher the simulation is, mm. */
export function heightDifferenceOf(residuals: Residuals, model: Model): Float64Array {
  const simulated = simulatedIn(residuals, model);
  return Float64Array.from(
    { length: residuals.count },
    (_, i) => (simulated[3 * i + 2] ?? 0) - (residuals.measured[3 * i + 2] ?? 0),
  );
}

export const heightsOf = (places: Float64Array): Float64Array =>
  Float64Array.from({ length: places.length / 3 }, (_, i) => places[3 * i + 2] ?? 0);

export const meanOf = (values: Float64Array): number =>
  values.length === 0 ? 0 : values.reduce((sum, value) => sum + value, 0) / values.length;

/** The value below which this share of all lies. */
export function percentile(values: Float64Array, share: number): number {
  const sorted = Float64Array.from(values).sort();
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? 0;
}

/** How many of the values lie in each of equal bins from 0; what lies beyond counts in the last. */
export function histogram(values: Float64Array, bins: number, maximum: number): number[] {
  const counts = new Array<number>(bins).fill(0);
  for (const value of values) {
    const bin = maximum > 0 ? Math.min(bins - 1, Math.max(0, Math.floor((bins * value) / maximum))) : 0;
    counts[bin] = (counts[bin] ?? 0) + 1;
  }
  return counts;
}

/** The next of 1, 2 or 5 times a power of ten that is not smaller. */
export function niceUp(value: number): number {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value) + 1e-9);
  return power * ([1, 2, 5, 10].find((step) => step * power >= value * (1 - 1e-9)) ?? 10);
}

/** The largest such number that is not larger. */
export const niceDown = (value: number): number => (value > 0 ? 1 / niceUp(1 / value) : 1);

export interface Arrow {
  /** Middle of the points it stands for, mm on the sheet. */
  readonly x: number;
  readonly y: number;
  /** Mean difference sideways, mm. */
  readonly dx: number;
  readonly dy: number;
}

export interface Extent {
  readonly low: readonly [number, number];
  readonly high: readonly [number, number];
}

export function extentOf({ sheet, count }: Residuals): Extent {
  const low: [number, number] = [Infinity, Infinity];
  const high: [number, number] = [-Infinity, -Infinity];
  for (let i = 0; i < count; ++i)
    for (const k of [0, 1] as const) {
      low[k] = Math.min(low[k], sheet[2 * i + k] ?? 0);
      high[k] = Math.max(high[k], sheet[2 * i + k] ?? 0);
    }
  return { low, high };
}

/** One arrow for the points in each of about cells x cells squares. */
export function arrowsOf(residuals: Residuals, model: Model, cells: number): Arrow[] {
  const { low, high } = extentOf(residuals);
  const side = cellSide(residuals, cells);
  const across = Math.max(1, Math.ceil((high[0] - low[0]) / side));
  const sums = new Map<number, [n: number, x: number, y: number, dx: number, dy: number]>();
  const simulated = simulatedIn(residuals, model);
  for (let i = 0; i < residuals.count; ++i) {
    const [x, y] = [residuals.sheet[2 * i] ?? 0, residuals.sheet[2 * i + 1] ?? 0];
    const cell = Math.floor((x - low[0]) / side) + (across + 1) * Math.floor((y - low[1]) / side);
    const sum = sums.get(cell) ?? [0, 0, 0, 0, 0];
    sum[0] += 1;
    sum[1] += x;
    sum[2] += y;
    sum[3] += (simulated[3 * i] ?? 0) - (residuals.measured[3 * i] ?? 0);
    sum[4] += (simulated[3 * i + 1] ?? 0) - (residuals.measured[3 * i + 1] ?? 0);
    sums.set(cell, sum);
  }
  return [...sums.values()].map(([n, x, y, dx, dy]) => ({ x: x / n, y: y / n, dx: dx / n, dy: dy / n }));
}

export function cellSide(residuals: Residuals, cells: number): number {
  const { low, high } = extentOf(residuals);
  return Math.max(high[0] - low[0], high[1] - low[1], 1e-6) / cells;
}

/** By how much lengths are drawn longer so that nearly all fit into `room`, in the unit of the lengths. */
export const scaleFor = (lengths: Float64Array, room: number): number =>
  niceDown(room / Math.max(percentile(lengths, 0.95), 1e-9));

/** Number of the nearest point on the sheet; null without any. */
export function nearestTo({ sheet, count }: Residuals, x: number, y: number): number | null {
  let best: number | null = null;
  let least = Infinity;
  for (let i = 0; i < count; ++i) {
    const distance = ((sheet[2 * i] ?? 0) - x) ** 2 + ((sheet[2 * i + 1] ?? 0) - y) ** 2;
    if (distance < least) [best, least] = [i, distance];
  }
  return best;
}

/** The nearest point that lies in a direction on the sheet, within 45° of it. */
export function neighbourOf(residuals: Residuals, from: number, dx: number, dy: number): number {
  const { sheet, count } = residuals;
  const [x, y] = [sheet[2 * from] ?? 0, sheet[2 * from + 1] ?? 0];
  let best = from;
  let least = Infinity;
  for (let i = 0; i < count; ++i) {
    const [u, v] = [(sheet[2 * i] ?? 0) - x, (sheet[2 * i + 1] ?? 0) - y];
    const along = u * dx + v * dy;
    const aside = Math.abs(u * dy - v * dx);
    if (along <= 1e-9 || aside > along) continue;
    const distance = along + 2 * aside;
    if (distance < least) [best, least] = [i, distance];
  }
  return best;
}

const rowNames = ['at the front', 'in the middle', 'at the back'];
const columnNames = ['left', '', 'right'];

/** Of nine fields of the sheet, as far as it was measured, the one with the largest mean distance, in words; null where the
 *  points are few or lie in one place. */
export function worstRegion(
  residuals: Residuals,
  model: Model,
): { readonly where: string; readonly mean_mm: number } | null {
  const distances = distancesOf(residuals, model);
  const { sheet, count } = residuals;
  const range = [0, 1].map((k) => {
    const values = Array.from({ length: count }, (_, i) => sheet[2 * i + k] ?? 0);
    // Not spread into arguments: a scan may have a hundred thousand points.
    return [
      values.reduce((a, b) => Math.min(a, b), Infinity),
      values.reduce((a, b) => Math.max(a, b), -Infinity),
    ] as const;
  });
  if (count < 6 || range.some(([low, high]) => !(high > low))) return null;
  const fields = Array.from({ length: 9 }, () => ({ sum: 0, points: 0 }));
  for (let i = 0; i < count; ++i) {
    const [column, row] = range.map(([low, high], k) =>
      Math.min(2, Math.floor((3 * ((sheet[2 * i + k] ?? 0) - low)) / (high - low))),
    );
    const field = fields[3 * (row ?? 0) + (column ?? 0)];
    if (field === undefined) continue;
    field.sum += distances[i] ?? 0;
    ++field.points;
  }
  const means = fields.map(({ sum, points }) => (points === 0 ? 0 : sum / points));
  const worst = means.indexOf(Math.max(...means));
  const [row, column] = [Math.floor(worst / 3), worst % 3];
  const where =
    row === 1 && column !== 1
      ? `on the ${columnNames[column] ?? ''}`
      : `${rowNames[row] ?? ''} ${columnNames[column] ?? ''}`.trim();
  return { where, mean_mm: means[worst] ?? 0 };
}

/** How far the extended simulation takes each point from where the calibrated one does, mm; 0 without one. */
export const movesOf = ({ base, extended, count }: Residuals): Float64Array =>
  Float64Array.from({ length: count }, (_, i) =>
    extended === null
      ? 0
      : Math.hypot(...[0, 1, 2].map((k) => (extended[3 * i + k] ?? 0) - (base[3 * i + k] ?? 0))),
  );

/** The same in two figures; null without an extended simulation. */
export function movedBy(
  residuals: Residuals,
): { readonly mean_mm: number; readonly largest_mm: number } | null {
  if (residuals.extended === null || residuals.count === 0) return null;
  const moved = movesOf(residuals);
  return { mean_mm: meanOf(moved), largest_mm: moved.reduce((a, b) => Math.max(a, b), 0) };
}
