// SPDX-License-Identifier: GPL-3.0-or-later
// Marks on a sheet that are measured with calipers: what was typed, as lengths and as the table that operations read.
import type { JsonObject, Report } from '../../../jobs/contract';
import type { BlobReference } from '../../../project/document';
import { isObject } from '../../../project/document';
import { lengthIn } from '../../../shared/diagnosis/length_in';
import type { RimReading } from './rim';
import { rimRows, thicknessColumns } from './rim';

type Pair = readonly [number, number];
type Triple = readonly [number, number, number];
type Typed = readonly [x: string, y: string, z: string];

/** Where a maker measures x and y from. Tables always count from the middle of the clamp opening. */
export type Origin = 'corner' | 'middle';

export interface HandMark {
  /** On the flat sheet, from its middle. */
  readonly sheet_mm: Pair;
  /** Where it should be on the formed sheet, from the middle of the opening and above the raised base plate. */
  readonly expected_mm: Triple;
  /** As it was typed, x and y from where `origin` says. */
  readonly typed: Typed;
}

export type HandMould =
  | { readonly kind: 'sample'; readonly sample: string; readonly title: string }
  | {
      readonly kind: 'model';
      readonly title: string;
      readonly mesh: BlobReference;
      readonly parameters: JsonObject;
    };

/** What was planned, and the request it answers. */
export interface HandPlan {
  readonly of: JsonObject;
  readonly report: Report;
  readonly mould: BlobReference;
  readonly setup: BlobReference;
  readonly drawing: BlobReference;
}

export interface ByHand {
  readonly mould: HandMould;
  readonly parameters: JsonObject;
  readonly origin: Origin;
  readonly marks: readonly HandMark[];
  /** Missing in projects that were kept before rims were measured. */
  readonly rim?: readonly RimReading[];
  readonly plan: HandPlan | null;
}

const untyped: Typed = ['', '', ''];
/** A diagnosis takes no fewer. */
export const minMeasured = 6;
/** Faults move a mark by some millimetres; what is farther off was misread or mistyped. */
const far_mm = 15;

const offset = (origin: Origin, opening_mm: Pair): Triple =>
  origin === 'corner' ? [opening_mm[0] / 2, opening_mm[1] / 2, 0] : [0, 0, 0];

/** What a maker should read about, from where they measure. */
export function expectedAt({ expected_mm }: HandMark, origin: Origin, opening_mm: Pair): Triple {
  const [x, y, z] = offset(origin, opening_mm);
  return [expected_mm[0] + x, expected_mm[1] + y, expected_mm[2] + z];
}

/** From the middle of the opening; null where a number is missing or none. */
export function placeOf({ typed }: HandMark, origin: Origin, opening_mm: Pair): Triple | null {
  const by = offset(origin, opening_mm);
  const [x, y, z] = typed.map((text, k) => {
    const length = lengthIn(text);
    return length === null ? null : length - (by[k] ?? 0);
  });
  return x === undefined || y === undefined || z === undefined || x === null || y === null || z === null
    ? null
    : [x, y, z];
}

/** What is wrong with what was typed, in a sentence; empty where nothing is. */
export function problemOf(mark: HandMark, origin: Origin, opening_mm: Pair): string {
  if (mark.typed.every((text) => text.trim() === '')) return '';
  const wrong = mark.typed.find((text) => text.trim() !== '' && lengthIn(text) === null);
  if (wrong !== undefined) return `“${wrong}” is not a length in millimetres.`;
  const place = placeOf(mark, origin, opening_mm);
  if (place === null) return 'Measure x, y and z, or leave the mark out.';
  const off = Math.hypot(...place.map((at, k) => at - (mark.expected_mm[k] ?? 0)));
  return off > far_mm ? `${Math.round(off)} mm from where it is expected: read it once more.` : '';
}

/** Typed anew for another origin: the places stay. */
export function fromOrigin(
  marks: readonly HandMark[],
  from: Origin,
  to: Origin,
  opening_mm: Pair,
): HandMark[] {
  const [a, b] = [offset(from, opening_mm), offset(to, opening_mm)];
  return marks.map((mark) => {
    const [x = '', y = '', z = ''] = mark.typed.map((text, k) => {
      const length = lengthIn(text);
      return length === null ? text : String(Number((length - (a[k] ?? 0) + (b[k] ?? 0)).toFixed(3)));
    });
    return { ...mark, typed: [x, y, z] };
  });
}

export const measuredMarks = ({ marks, origin }: ByHand, opening_mm: Pair) =>
  marks.filter((mark) => placeOf(mark, origin, opening_mm) !== null);

/** measured.csv of what was measured so far. */
export function measuredTable(byHand: ByHand, opening_mm: Pair, sigma_mm: number): string {
  const rows = byHand.marks.flatMap((mark) => {
    const place = placeOf(mark, byHand.origin, opening_mm);
    return place ? [[...mark.sheet_mm, ...place.map((at) => Number(at.toFixed(4))), sigma_mm].join(',')] : [];
  });
  const columns = 'sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,sigma_mm';
  const rim = rimRows(byHand.rim ?? []);
  if (rim.length === 0) return [columns, ...rows, ''].join('\n');
  return [`${columns},${thicknessColumns}`, ...rows.map((row) => `${row},,`), ...rim, ''].join('\n');
}

const numbersIn = (value: unknown, names: readonly string[]): number[] | null => {
  if (!isObject(value)) return null;
  const found = names.map((name) => value[name]);
  return found.every((one): one is number => typeof one === 'number') ? found : null;
};

/** The chosen marks of a report, nothing typed yet. */
export function marksIn(report: Report): HandMark[] {
  const list: unknown = report['marks'];
  if (!Array.isArray(list)) return [];
  return (list as readonly unknown[]).flatMap((row) => {
    const found = numbersIn(row, [
      'sheet_x_mm',
      'sheet_y_mm',
      'expected_x_mm',
      'expected_y_mm',
      'expected_z_mm',
    ]);
    if (found === null) return [];
    const [u = 0, v = 0, x = 0, y = 0, z = 0] = found;
    return [{ sheet_mm: [u, v], expected_mm: [x, y, z], typed: untyped }];
  });
}

/** A pair of lengths of a report; null where it has none. */
export function pairIn(report: Report, name: string): Pair | null {
  const value: unknown = report[name];
  if (!Array.isArray(value)) return null;
  const [x, y] = value as readonly unknown[];
  return typeof x === 'number' && typeof y === 'number' ? [x, y] : null;
}

export interface Outlook {
  readonly name: string;
  readonly label: string;
  readonly unit: string;
  readonly shows: boolean;
  readonly usual: number;
  /** Null where the sheet's material imitates the cause. */
  readonly visibleFrom: number | null;
  readonly best: number | null;
}

/** Which causes the marks of a report would show, those that they do first. */
export function outlooksIn(report: Report): Outlook[] {
  const list: unknown = report['causes'];
  if (!Array.isArray(list)) return [];
  const found = (list as readonly unknown[]).flatMap((row) => {
    if (!isObject(row)) return [];
    const { name, label, unit, shows } = row;
    const [usual, from, best] = ['usual_strength', 'min_visible_strength', 'best_visible_strength'].map(
      (key) => {
        const value = row[key];
        return typeof value === 'number' ? value : null;
      },
    );
    if (typeof name !== 'string' || typeof label !== 'string' || typeof unit !== 'string') return [];
    return [
      {
        name,
        label,
        unit,
        shows: shows === true,
        usual: usual ?? 0,
        visibleFrom: from ?? null,
        best: best ?? null,
      },
    ];
  });
  return [...found.filter(({ shows }) => shows), ...found.filter(({ shows }) => !shows)];
}
