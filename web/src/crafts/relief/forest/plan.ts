// SPDX-License-Identifier: GPL-3.0-or-later
// What the core found in the floor plan: plan.json, and the shares of the report.
import type { Report } from '../../../jobs/contract';
import { isObject } from '../../../project/document';
import type { Place } from './scene';

interface Surface {
  /** From 1. */
  readonly pillar: number;
  readonly line_mm: readonly Place[];
}

export interface Plan {
  readonly viewpoints: readonly {
    readonly eye_mm: Place;
    /** The area that it sees in its range. */
    readonly sight_mm: readonly Place[];
    /** What is its own. */
    readonly surfaces: readonly Surface[];
  }[];
  readonly pillars_mm: readonly (readonly Place[])[];
  /** What two viewpoints see. */
  readonly shared: readonly (Surface & { readonly viewpoints: readonly number[] })[];
}

/** Of bytes that the core wrote; an earlier worker does not say what is shared. */
export function readPlan(bytes: Uint8Array): Plan {
  const read = JSON.parse(new TextDecoder().decode(bytes)) as Omit<Plan, 'shared'> & Partial<Plan>;
  return { ...read, shared: read.shared ?? [] };
}

export interface ViewFigures {
  readonly model: string;
  readonly shares: Readonly<Record<string, number>>;
}

/** One row a viewpoint of a list of the report, with the numbers that it has. */
export function figuresOf(report: Report, name: 'in_plan' | 'viewpoints'): ViewFigures[] {
  const rows = report[name];
  return (Array.isArray(rows) ? rows : []).filter(isObject).map((row) => ({
    model: typeof row['model'] === 'string' ? row['model'] : '',
    shares: Object.fromEntries(
      Object.entries(row).filter((entry): entry is [string, number] => typeof entry[1] === 'number'),
    ),
  }));
}
