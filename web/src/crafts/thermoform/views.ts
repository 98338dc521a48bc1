// SPDX-License-Identifier: GPL-3.0-or-later
// What the viewport shows, and in which colours. It outlives a visit to another page.
import { signal } from '@preact/signals';
import type { ColourMapping } from '../../view';
import { printing } from './thermoform_document';
import type { Formed, ThermoformSession } from './thermoform_session';
import { moulding } from './thermoform_document';

export type View = 'texture' | 'thickness' | 'stretch' | 'undercut';

export const view = signal<View>('thickness');
let openedLast: string | null = null;
/** A model that comes with colours is shown in them, until another view is chosen. */
export function chooseViewFor(model: string, hasColours: boolean): void {
  if (openedLast === model) return;
  openedLast = model;
  if (hasColours) view.value = 'texture';
  else if (view.peek() === 'texture') view.value = 'thickness';
}
/** Model left of the divider, sheet right of it. */
export const swiping = signal(false);
/** A model is being moved about. */
export const dragging = signal(false);
export const playing = signal(false);

const viewNames: readonly { readonly value: View; readonly label: string }[] = [
  { value: 'texture', label: 'Texture' },
  { value: 'thickness', label: 'Thickness' },
  { value: 'stretch', label: 'Stretch' },
  { value: 'undercut', label: 'Undercut' },
];

/** Views that this build can fill; without a print the texture is the plain sheet. */
export const offeredViews = (session: ThermoformSession) =>
  viewNames
    .filter(({ value }) => value !== 'undercut' || session.operationNamed(moulding) !== undefined)
    .map((option) =>
      option.value === 'texture' && session.operationNamed(printing) === undefined
        ? { ...option, label: 'Sheet' }
        : option,
    );

const niceUp = (value: number): number => {
  const power = 10 ** Math.floor(Math.log10(value));
  return Math.ceil((2 * value) / power - 1e-9) * (power / 2);
};

/** Walls that part from the sheet by themselves are pale, what leans in further than this is dark. */
const overhangRange_deg = [-5, 30] as const;

/** The colours of a view of a formed sheet; one scale for all moments of the film. */
export function mappingOf(which: View, formed: Formed, sheetThickness_mm: number): ColourMapping | null {
  if (which === 'thickness') {
    const thin = minOf(formed.sheet.attributes['thickness_mm']) ?? sheetThickness_mm;
    const step = 0.2 * sheetThickness_mm;
    return {
      attribute: 'thickness_mm',
      map: 'thickness',
      minimum: Number((step * Math.floor(thin / step)).toFixed(6)),
      maximum: sheetThickness_mm,
      unit: 'mm',
      label: 'Thickness',
    };
  }
  if (which === 'stretch') {
    const most = -(minOf(formed.sheet.attributes['stretch']?.map((x) => -x)) ?? -1.5);
    return {
      attribute: 'stretch',
      map: 'error',
      minimum: 1,
      maximum: Math.max(1.5, niceUp(most)),
      unit: '×',
      label: 'Stretch',
    };
  }
  if (which === 'undercut')
    return {
      attribute: 'overhang_deg',
      map: 'error',
      minimum: overhangRange_deg[0],
      maximum: overhangRange_deg[1],
      unit: '°',
      label: 'Overhang',
    };
  return null;
}

function minOf(values: Float32Array | undefined): number | null {
  let least = Infinity;
  for (const value of values ?? []) if (value < least) least = value;
  return Number.isFinite(least) ? least : null;
}
