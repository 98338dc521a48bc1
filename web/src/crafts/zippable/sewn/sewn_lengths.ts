// SPDX-License-Identifier: GPL-3.0-or-later
// Lengths that are measured on a sewn zippable: which, what is expected, what was read.
import type { Json, Report } from '../../../jobs/contract';
import type { BlobReference } from '../../../project/document';
import { isObject } from '../../../project/document';
import { lengthIn } from '../../../shared/diagnosis/length_in';

export interface SewnLength {
  /** "12", or "12L" and "12R" on the flat pieces. */
  readonly from: string;
  readonly to: string;
  readonly state: 'flat' | 'zipped';
  readonly expected_mm: number;
  /** As it was typed; empty: not measured. */
  readonly measured: string;
}

/** What a diagnosis said, and of which lengths. */
export interface SewnFinding {
  readonly of: string;
  readonly report: Report;
  /** Of making, by name: what a plan can make up for. */
  readonly errors: Readonly<Record<string, number>>;
}

export interface SewnCheck {
  /** The design that it is about. */
  readonly design: string;
  /** What the plan says of how pieces lay on their sheets. */
  readonly plan: BlobReference;
  /** What that plan made up for already, by the names of the errors of making. */
  readonly corrected: Readonly<Record<string, number>>;
  /** What these lengths would show, in a sentence. */
  readonly outlook: string;
  readonly lengths: readonly SewnLength[];
  readonly found: SewnFinding | null;
}

/** The report of evidence-plan-lengths as rows to fill in. */
export function lengthsIn(report: Report): SewnLength[] {
  const list = report['lengths'];
  return (Array.isArray(list) ? (list as readonly Json[]) : []).filter(isObject).flatMap((row) => {
    const { from, to, state, expected_mm } = row;
    const known = state === 'flat' || state === 'zipped';
    return typeof from === 'string' && typeof to === 'string' && known && typeof expected_mm === 'number'
      ? [{ from, to, state, expected_mm, measured: '' }]
      : [];
  });
}

/** Diagnoses need so many. */
export const minLengths = 6;

export const isMeasured = ({ measured }: SewnLength): boolean => {
  const length = lengthIn(measured);
  return length !== null && length > 0;
};

/** What is wrong with a number that was typed; null where nothing is. */
export function problemOf(length: SewnLength): string | null {
  if (length.measured.trim() === '' || isMeasured(length)) return null;
  return 'Type a length in millimetres, such as 143.5';
}

/** A length that is far from what is expected is more often a wrong mark than a wrong shape. */
export function isStrange(length: SewnLength): boolean {
  const { expected_mm } = length;
  const measured = lengthIn(length.measured);
  return measured !== null && Math.abs(measured - expected_mm) > 10 + 0.3 * expected_mm;
}

/** lengths.csv with what was measured. */
export function lengthsCsv(lengths: readonly SewnLength[]): string {
  const rows = lengths.filter(isMeasured).map(({ from, to, state, measured }) => {
    const length = lengthIn(measured);
    return `${from},${to},${state},${length}`;
  });
  return ['from,to,state,length_mm', ...rows, ''].join('\n');
}

/** In the order in which they are measured: first what lies flat, which is gone once it is sewn. */
export const inOrder = (lengths: readonly SewnLength[]): SewnLength[] =>
  [...lengths].sort((a, b) => Number(a.state === 'zipped') - Number(b.state === 'zipped'));
