// SPDX-License-Identifier: GPL-3.0-or-later
// What the view of the forest shows, and what its parts are called. Outlives a visit to another page.
import { signal } from '@preact/signals';
import { colourToken } from '../../../shared/panels/colour_token';
import { formatFixed } from '../../../ui';
import type { ForestSession } from './forest_session';
import type { Chosen, Pillar, Viewpoint } from './scene';
import { isShaped, rounded } from './scene';

export type ForestView = 'plan' | 'space' | 'pictures';
export const view = signal<ForestView>('plan');
/** The plan leaves out eyes that stand far away, or shows everything. */
export const planReach = signal<'pillars' | 'eyes'>('pillars');

/** Whether the plan has beside it what an eye sees; null: where there is room. */
export const eyeShown = signal<boolean | null>(null);

export const colourOf = (viewpoint: number): string => `var(${colourToken(viewpoint)})`;

/** "Bust", "lion". */
export function modelName(session: ForestSession, { sample, model }: Viewpoint): string {
  if (model !== undefined)
    return session.document.value.models[model - 1]?.file_name.replace(/\.[^.]+$/, '') ?? `Model ${model}`;
  const samples = session.services.catalog.value?.samples ?? [];
  return samples.find(({ name }) => name === sample)?.title ?? sample ?? '';
}

export const shapeNames = { round: 'Round', square: 'Square', hexagon: 'Hexagonal' } as const;
export const outlineName = 'Own outline';

export const shapeName = (pillar: Pillar): string =>
  isShaped(pillar) ? shapeNames[pillar.shape] : outlineName;

/** "12, −40.5 mm". */
export const placeWords = ([x, y]: readonly number[]): string => `${placeNumber(x)}, ${placeNumber(y)} mm`;

/** Whole where it is whole. */
export const placeNumber = (value = 0): string =>
  formatFixed(rounded(value), Number.isInteger(rounded(value)) ? 0 : 1);

export const isChosen = (chosen: Chosen | null, kind: Chosen['kind'], index: number): boolean =>
  chosen?.kind === kind && chosen.index === index;
