// SPDX-License-Identifier: GPL-3.0-or-later
// What a slicer writes about its print into the comments of its G-code.

export interface PrintFacts {
  readonly seconds: number | null;
  readonly filament_g: number | null;
  readonly filament_mm: number | null;
}

/** PrusaSlicer, OrcaSlicer and SuperSlicer write the same comments, near the end. */
export function printFacts(gcode: Uint8Array): PrintFacts {
  const text = new TextDecoder('utf-8', { fatal: false }).decode(gcode.subarray(-65536));
  const number = (pattern: RegExp) => {
    const found = Number(pattern.exec(text)?.[1]);
    return Number.isFinite(found) ? found : null;
  };
  const time = /^; estimated printing time \(normal mode\) = (.+)$/m.exec(text)?.[1];
  return {
    seconds: time === undefined ? null : secondsOf(time),
    filament_g: number(/^; (?:total )?filament used \[g\] = ([\d.]+)/m),
    filament_mm: number(/^; filament used \[mm\] = ([\d.]+)/m),
  };
}

/** "1d 2h 3m 4s". */
function secondsOf(words: string): number | null {
  const units: Record<string, number> = { d: 86400, h: 3600, m: 60, s: 1 };
  const parts = [...words.matchAll(/(\d+)\s*([dhms])/g)];
  if (parts.length === 0) return null;
  return parts.reduce((sum, [, count, unit]) => sum + Number(count) * (units[unit ?? ''] ?? 0), 0);
}
