// SPDX-License-Identifier: GPL-3.0-or-later
// What a laser says about the sheets that are cut on it: for who lays pieces out, which knows no machines.
import type { JsonObject } from '../jobs/contract';

/** Part of projects: what is laid out for a laser keeps what that laser was like. */
export interface LaserSheet extends JsonObject {
  /** The machine's name. */
  readonly laser: string;
  readonly bed_x_mm: number;
  readonly bed_y_mm: number;
  /** The chosen material, if it is known how wide the laser cuts in it. */
  readonly material: string | null;
  readonly kerf_mm: number | null;
}

export const sameBed = (a: LaserSheet, b: LaserSheet): boolean =>
  a.bed_x_mm === b.bed_x_mm && a.bed_y_mm === b.bed_y_mm;
