// SPDX-License-Identifier: GPL-3.0-or-later
// What the page and the Web Worker that reads tool paths tell each other.
import type { ToolPath } from './toolpath';

export type ToolPathRequest = { readonly id: number; readonly bytes: Uint8Array<ArrayBuffer> } & (
  | { readonly kind: 'toolpath' }
  | {
      readonly kind: 'gcode';
      readonly bed_mm: readonly [number, number];
      readonly power_max_s: number;
    }
);
export type ToolPathReply = { readonly id: number } & (
  { readonly toolPath: ToolPath } | { readonly error: string }
);
