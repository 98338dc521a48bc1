// SPDX-License-Identifier: GPL-3.0-or-later
// Thermoforming's part of a project: formed sheets as results, and what was made of them: prints, moulds.
import type { Catalog, JsonObject, Operation } from '../../jobs/contract';
import type { CraftDocument, CraftResult, Source, Subject } from '../../shared/session/craft_document';
import { CraftCommands, emptyCraft, sameRequest } from '../../shared/session/craft_document';
import type { RoomWithProducts } from '../../shared/session/products';
import { offeredTogether } from '../../shared/session/products';

export type ThermoformDocument = CraftDocument & RoomWithProducts;

export const simulate = 'thermoform-simulate';
/** Of what is made of a formed sheet; a build offers those that its catalog names. */
export const printing = 'thermoform-texture';
export const moulding = 'thermoform-mould';

export const thermoform = new CraftCommands<ThermoformDocument>('thermoform', {
  ...emptyCraft,
  products: [],
});

/** The simulation with the parameters of everything that is made of its result. */
export const offered = (catalog: Catalog): Operation | null =>
  offeredTogether(catalog, simulate, [printing, moulding]);

/** The sheet formed with exactly these parameters over the subject, if there is one. */
export function formedSheet(
  { results }: ThermoformDocument,
  subject: Subject | null,
  parameters: JsonObject,
): CraftResult | null {
  if (subject === null) return null;
  const request = { mesh: subject.key, parameters };
  return results.find((result) => sameRequest(result, request)) ?? null;
}

/** Whether a file of materials came with the model, which says the colours of its parts. */
export const hasMaterials = (source: Source): boolean =>
  source.kind === 'file' &&
  (source.companions ?? []).some(({ file_name }) => file_name.toLowerCase().endsWith('.mtl'));
