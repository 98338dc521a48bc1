// SPDX-License-Identifier: GPL-3.0-or-later
// Colour maps: the same stops as the tokens --map-*, sampled for the mesh and written as a legend.
import type { ColourMapName, ColourMapping, LegendData } from '../api';

export type Rgb = readonly [number, number, number];

/** Used where no style sheet defines the tokens (tests, thumbnails off the page). */
const DEFAULT_STOPS: Record<ColourMapName, readonly string[]> = {
  thickness: [
    '#06163f',
    '#172e7c',
    '#21579f',
    '#1f87b8',
    '#41b0c2',
    '#7fcdbb',
    '#c0e3bc',
    '#e6f2c8',
    '#f6f5df',
  ],
  brightness: ['#000000', '#ffffff'],
  error: ['#faf6e6', '#fbedbe', '#fddd8a', '#fbbf52', '#f0963a', '#db6b2a', '#b2471c', '#7e2d14', '#4a1a10'],
  signed: [
    '#001261',
    '#023e7d',
    '#1e6f9d',
    '#71a8c4',
    '#c9dde7',
    '#ebe5e0',
    '#eacebd',
    '#d39774',
    '#be6533',
    '#8b2706',
    '#590008',
  ],
};

/** "#rgb", "#rrggbb" or "rgb(…)" to 0..255; null for anything else. */
export function parseColour(text: string): Rgb | null {
  const hex = /^#([0-9a-f]{3}|[0-9a-f]{6})$/i.exec(text.trim())?.[1];
  if (hex) {
    const six = hex.length === 3 ? [...hex].map((d) => d + d).join('') : hex;
    const n = parseInt(six, 16);
    return [n >> 16, (n >> 8) & 255, n & 255];
  }
  const parts = /^rgba?\(([^)]*)\)$/i
    .exec(text.trim())?.[1]
    ?.split(/[\s,/]+/)
    .map(Number);
  if (!parts || parts.length < 3 || parts.slice(0, 3).some((p) => !Number.isFinite(p))) return null;
  return [parts[0] as number, parts[1] as number, parts[2] as number];
}

/** The evenly spaced stops of a token like "linear-gradient(90deg, #faf6e6, …)", or the map's own. */
export function stopsOf(name: ColourMapName, token?: string): Rgb[] {
  const found = token?.match(/#[0-9a-f]{6}\b|#[0-9a-f]{3}\b|rgba?\([^)]*\)/gi)?.map(parseColour) ?? [];
  const stops = found.filter((stop): stop is Rgb => stop !== null);
  if (stops.length >= 2) return stops;
  return DEFAULT_STOPS[name].map((stop) => parseColour(stop) ?? [0, 0, 0]);
}

/** Colour at `fraction`, clamped to 0..1, 0..255 per channel; blends evenly in sRGB as CSS gradients do. */
export function sampleStops(stops: readonly Rgb[], fraction: number): Rgb {
  const last = stops.length - 1;
  const at = Math.min(1, Math.max(0, fraction)) * last;
  const i = Math.min(last - 1, Math.floor(at));
  const a = stops[i] as Rgb;
  const b = stops[i + 1] as Rgb;
  const t = at - i;
  return [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t];
}

/** `size` texels, r, g, b, a bytes. */
export function mapTexels(stops: readonly Rgb[], size: number): Uint8Array {
  const texels = new Uint8Array(4 * size);
  for (let i = 0; i < size; ++i) {
    const [r, g, b] = sampleStops(stops, i / (size - 1));
    texels.set([Math.round(r), Math.round(g), Math.round(b), 255], 4 * i);
  }
  return texels;
}

/** A thin space before units, none before degrees; a true minus; two or three digits. */
export function formatValue(value: number, unit: string, step?: number): string {
  const size = Math.abs(value);
  const digits = step !== undefined ? decimalsOf(step) : size >= 100 || size === 0 ? 0 : size >= 10 ? 1 : 2;
  const text = size.toFixed(Math.min(digits, 6));
  const sign = value < 0 && Number(text) !== 0 ? '\u2212' : '';
  return sign + text + (unit === '' ? '' : /^[°%′″]/.test(unit) && unit !== '%' ? unit : `\u2009${unit}`);
}

/** As few as tell the steps apart: two for 0.25. */
function decimalsOf(step: number): number {
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return Math.abs(step * 10 ** digits - Math.round(step * 10 ** digits)) > 1e-6 ? digits + 1 : digits;
}

/** Steps of 1, 2, 2.5 or 5 times a power of ten, about `wanted` of them. */
export function tickStep(minimum: number, maximum: number, wanted: number): number {
  const raw = (maximum - minimum) / wanted;
  if (!(raw > 0) || !Number.isFinite(raw)) return 1;
  const power = 10 ** Math.floor(Math.log10(raw));
  const ratio = raw / power;
  return power * (ratio < 1.5 ? 1 : ratio < 2.2 ? 2 : ratio < 3.5 ? 2.5 : ratio < 7.5 ? 5 : 10);
}

export interface ValueStatistics {
  minimum: number;
  maximum: number;
  mean: number;
  count: number;
}

/** Of the values that are numbers; null where there are none. `weights` (areas) make the mean independent of meshing. */
export function statisticsOf(values: Float32Array, weights?: ArrayLike<number>): ValueStatistics | null {
  let minimum = Infinity;
  let maximum = -Infinity;
  let sum = 0;
  let total = 0;
  let count = 0;
  for (let i = 0; i < values.length; ++i) {
    const value = values[i] as number;
    if (Number.isNaN(value)) continue;
    const weight = weights ? (weights[i] ?? 0) : 1;
    ++count;
    if (value < minimum) minimum = value;
    if (value > maximum) maximum = value;
    sum += weight * value;
    total += weight;
  }
  return count === 0 || !(total > 0) ? null : { minimum, maximum, mean: sum / total, count };
}

/** What a legend says: bar, ticks, the marked value (mean; thinnest for thickness) and one spoken sentence.
 *  What is known better (a mean weighted by visible area, the least of a finer measure) goes into `known`. */
export function legendFor(
  mapping: ColourMapping,
  values: Float32Array | null,
  known?: { mean?: number; least?: number },
): LegendData {
  const { minimum, maximum, unit, label, map } = mapping;
  const span = maximum - minimum;
  const fraction = (value: number): number =>
    span > 0 ? Math.min(1, Math.max(0, (value - minimum) / span)) : 0;
  const step = tickStep(minimum, maximum, 3);
  const ticks: { value: number; fraction: number; text: string }[] = [];
  for (let i = Math.ceil(minimum / step - 1e-9); i * step <= maximum + 1e-9 * step; ++i) {
    ticks.push({ value: i * step, fraction: fraction(i * step), text: formatValue(i * step, '', step) });
  }
  // Degrees are short enough to stand at every tick, other units only at the last.
  ticks.forEach((tick, i) => {
    if (unit === '°' || i === ticks.length - 1) tick.text = formatValue(tick.value, unit, step);
  });
  const statistics = values ? statisticsOf(values) : null;
  let mark: LegendData['mark'] = null;
  if (map === 'thickness' && statistics) {
    const least = known?.least ?? statistics.minimum;
    mark = { value: least, fraction: fraction(least), text: `thinnest ${formatValue(least, unit)}` };
  } else {
    const mean = known?.mean ?? statistics?.mean;
    if (mean !== undefined)
      mark = { value: mean, fraction: fraction(mean), text: `mean ${formatValue(mean, unit)}` };
  }
  const range = `${label}: colours from ${formatValue(minimum, unit)} to ${formatValue(maximum, unit)}`;
  const found = statistics
    ? `, values from ${formatValue(statistics.minimum, unit)} to ${formatValue(statistics.maximum, unit)}`
    : '';
  return {
    label,
    unit,
    gradient: `var(--map-${map})`,
    minimum,
    maximum,
    ticks,
    mark,
    summary: `${range}${found}${mark ? `, ${mark.text}` : ''}.`,
  };
}
