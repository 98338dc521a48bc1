// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers as a person reads and writes them: true minus, thin space before units, either decimal mark.

const thinSpace = '\u2009';
const trueMinus = '\u2212';

/** At most `digits` significant digits, no exponent for usual sizes. */
export function formatNumber(value: number, digits = 3): string {
  if (!Number.isFinite(value)) return '–';
  const magnitude = value === 0 ? 0 : Math.floor(Math.log10(Math.abs(value)));
  const decimals = Math.max(0, Math.min(8, digits - 1 - magnitude));
  return withMinus(value.toFixed(decimals));
}

export const formatFixed = (value: number, decimals: number): string => withMinus(value.toFixed(decimals));
export const formatCount = (value: number): string => withMinus(Math.round(value).toLocaleString('en'));
const withMinus = (text: string) => text.replace(/^-/, trueMinus);

/** "5.0 mm"; degrees and no unit follow without a space. */
export function withUnit(number: string, unit: string): string {
  if (unit === '') return number;
  return unit === '°' ? number + unit : `${number}${thinSpace}${unit}`;
}

/** "0.84 m", as tape is bought. */
export const formatMetres = (mm: number): string => withUnit(formatFixed(mm / 1000, 2), 'm');

/** Null for what is no number. */
export function parseNumber(text: string): number | null {
  const plain = text
    .trim()
    .replaceAll(trueMinus, '-')
    .replaceAll(/[\s\u2009\u202f]/g, '')
    .replace(',', '.');
  if (!/^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(plain)) return null;
  const value = Number(plain);
  return Number.isFinite(value) ? value : null;
}

/** The round step, 1 or 5 times a power of ten, that divides a range into 150 steps or somewhat more. */
export function niceStep(from: number, to: number): number {
  const wanted = Math.abs(to - from) / 150;
  if (!(wanted > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(wanted));
  return wanted / power >= 5 ? 5 * power : power;
}

export const decimalsOf = (step: number): number => Math.max(0, -Math.floor(Math.log10(step) + 1e-9));

/** `value` on the grid of `step`, free of binary dust. */
export const roundTo = (value: number, step: number): number =>
  Number((Math.round(value / step) * step).toFixed(decimalsOf(step) + 1));

/** As many decimals as the step shows, more where the value has them. */
export function formatOnStep(value: number, step: number): string {
  const decimals = decimalsOf(step);
  const rounded = Number(value.toFixed(decimals));
  return rounded === value ? formatFixed(value, decimals) : withMinus(String(Number(value.toPrecision(6))));
}

/** "25 s", "4 min", "4 h 15 min". */
export function formatDuration(seconds: number): string {
  if (seconds < 0.05) return `under ${withUnit('0.1', 's')}`;
  if (seconds < 10) return withUnit(seconds.toFixed(1), 's');
  if (seconds < 100) return withUnit(String(Math.round(seconds)), 's');
  const minutes = Math.round(seconds / 60);
  if (minutes < 120) return withUnit(String(minutes), 'min');
  const [hours, rest] = [withUnit(String(Math.floor(minutes / 60)), 'h'), minutes % 60];
  return rest === 0 ? hours : `${hours} ${withUnit(String(rest), 'min')}`;
}

export function formatBytes(bytes: number): string {
  if (bytes < 1000) return withUnit(String(bytes), 'bytes');
  if (bytes < 1e6) return withUnit(formatNumber(bytes / 1e3), 'kB');
  if (bytes < 1e9) return withUnit(formatNumber(bytes / 1e6), 'MB');
  return withUnit(formatNumber(bytes / 1e9), 'GB');
}
