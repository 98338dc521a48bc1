// SPDX-License-Identifier: GPL-3.0-or-later
// What a craft asks to have printed; the app shows the dialog, which comes when it is first needed.
import { signal } from '@preact/signals';

/** A picture (PNG) or a drawing (SVG) that tells its size, or pages (PDF) that were laid out already. */
export interface Printable {
  /** In a sentence: "the plan of the star". */
  readonly title: string;
  readonly fileName: string;
  readonly bytes: Uint8Array<ArrayBuffer>;
}

/** A solid (STL, 3MF) for a 3D printer. */
export type Solid = Printable;

export const toPrint = signal<Printable | null>(null);
export const toSlice = signal<Solid | null>(null);

export const printOnPaper = (printable: Printable): void => {
  toPrint.value = printable;
};
export const printInPlastic = (solid: Solid): void => {
  toSlice.value = solid;
};
