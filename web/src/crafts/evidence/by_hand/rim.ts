// SPDX-License-Identifier: GPL-3.0-or-later
// How thick the clamped rim is, measured with calipers in the middle of each side.
import type { Report } from '../../../jobs/contract';
import { isObject } from '../../../project/document';
import { lengthIn } from '../../../shared/diagnosis/length_in';

export interface RimReading {
  readonly side: string;
  /** On the flat sheet, from its middle. */
  readonly sheet_mm: readonly [number, number];
  /** How thick the set-up has the sheet. */
  readonly expected_mm: number;
  readonly typed: string;
}

/** Columns of measured.csv that follow those of marks. */
export const thicknessColumns = 'thickness_mm,thickness_sigma_mm';
/** A sheet only gets thinner; what is thicker than this many sheets was mistyped. */
const maxShare = 2;

/** Null where nothing was typed, or no thickness. */
export function thicknessIn({ typed }: RimReading): number | null {
  const length = lengthIn(typed);
  return length !== null && length > 0 ? length : null;
}

/** What is wrong with what was typed, in a sentence; empty where nothing is. */
export function rimProblem(reading: RimReading): string {
  if (reading.typed.trim() === '') return '';
  const thickness = thicknessIn(reading);
  if (thickness === null) return `“${reading.typed}” is not a thickness in millimetres.`;
  return thickness > maxShare * reading.expected_mm || thickness < reading.expected_mm / maxShare
    ? `The sheet should be about ${reading.expected_mm} mm thick: read it once more.`
    : '';
}

export const measuredRim = (rim: readonly RimReading[]) =>
  rim.filter((reading) => thicknessIn(reading) !== null);

/** Rows of measured.csv; 0 stands for the usual error of calipers. */
export const rimRows = (rim: readonly RimReading[]): string[] =>
  measuredRim(rim).map((reading) => [...reading.sheet_mm, ',,,', thicknessIn(reading), 0].join(','));

/** The places of a report, nothing typed yet. */
export function rimIn(report: Report): RimReading[] {
  const list: unknown = report['rim'];
  if (!Array.isArray(list)) return [];
  return (list as readonly unknown[]).flatMap((row) => {
    if (!isObject(row)) return [];
    const { side, sheet_x_mm: x, sheet_y_mm: y, expected_mm } = row;
    return typeof side === 'string' &&
      typeof x === 'number' &&
      typeof y === 'number' &&
      typeof expected_mm === 'number'
      ? [{ side, sheet_mm: [x, y] as const, expected_mm, typed: '' }]
      : [];
  });
}
