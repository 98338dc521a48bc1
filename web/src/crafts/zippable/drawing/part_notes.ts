// SPDX-License-Identifier: GPL-3.0-or-later
// What speaks against a part, in words.
import { formatFixed } from '../../../ui';
import { partName } from '../design';
import type { PartDistortion } from '../ribbon/part_map';

/** Twice what the most limb-rich of the samples reaches: the flat map says little about the part then. */
const poor = 3;

/** The core's own words about the part where it has some, else its distortion where that is large. */
export function partWarning(
  part: number,
  notes: readonly string[],
  distortion: PartDistortion | undefined,
): string | null {
  const head = `${partName(part)} `;
  const own = notes.find((note) => note.startsWith(head))?.slice(head.length);
  if (own) return own.charAt(0).toUpperCase() + own.slice(1);
  if (distortion && distortion.mean > poor)
    return `Badly distorted: ${formatFixed(distortion.mean, 1)} on average.`;
  return null;
}

/** Of a part without a warning. The samples' parts have mean distortions of 1.1 to 1.7 (docs/zippable.md). */
export function unwrapWords(distortion: PartDistortion | undefined): string {
  const usual = 1.7;
  return (distortion?.mean ?? 1) <= usual ? 'Unwraps well.' : 'Unwraps unevenly.';
}
