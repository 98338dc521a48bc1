// SPDX-License-Identifier: GPL-3.0-or-later
// What the panes show and point at. Outlives a visit to another page.
import { signal } from '@preact/signals';
import type { ColourMapping } from '../../view';
import type { Place } from './ribbon/ribbon_places';
import type { Zippable } from './zippable_session';

export type View = 'parts' | 'distortion' | 'ribbon';

export const view = signal<View>('parts');
/** What the right pane shows: the ribbon in one piece, the sheets that it is cut from, or the boards of its rig. */
export const flatView = signal<'ribbon' | 'sheets' | 'rig'>('ribbon');
/** The part whose row is chosen; null: all alike. */
export const chosenPart = signal<number | null>(null);
/** Where the ribbon is pointed at; two places where that is the seam. */
export const pointed = signal<{
  readonly places: readonly Place[];
  readonly along_mm: number | null;
} | null>(null);
/** How far the ribbon in space is bent: 0 flat, 1 zipped up. */
export const bend = signal(1);
/** Whether the bending is drawn from the design, or as simulated cloth did it. */
export const course = signal<'drawn' | 'simulated'>('drawn');
export const playing = signal(false);
/** Raised when the camera moves: what stands over the model follows. */
export const cameraMoves = signal(0);
/** Raised when the page's theme changes: colours that are not styles are read again. */
export const themeChanges = signal(0);

export const viewNames: readonly { readonly value: View; readonly label: string }[] = [
  { value: 'parts', label: 'Parts' },
  { value: 'distortion', label: 'Distortion' },
  { value: 'ribbon', label: 'Zipped' },
];

/** From no distortion to where all but two in a hundred vertices are. */
export function distortionMapping({ model }: Zippable): ColourMapping {
  const values = Float32Array.from(model.mesh.attributes['distortion'] ?? [1]).sort();
  const most = values[Math.floor(0.98 * (values.length - 1))] ?? 2;
  return {
    attribute: 'distortion',
    map: 'error',
    minimum: 1,
    maximum: Math.max(1.5, Math.ceil(2 * most) / 2),
    unit: '',
    label: 'Distortion',
  };
}
