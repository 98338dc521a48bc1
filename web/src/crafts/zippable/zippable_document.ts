// SPDX-License-Identifier: GPL-3.0-or-later
// The zippable's part of a project.
import type { Catalog, JsonObject, Operation } from '../../jobs/contract';
import type { BlobReference } from '../../project/document';
import type { CraftDocument, CraftResult, Subject } from '../../shared/session/craft_document';
import { CraftCommands, emptyCraft, sameRequest } from '../../shared/session/craft_document';
import type { RoomWithProducts } from '../../shared/session/products';
import { offeredTogether } from '../../shared/session/products';
import type { Drawn } from './drawing/drawn_parts';
import { nothingDrawn } from './drawing/drawn_parts';

export const design = 'zippable-design';
/** What is made of a design; a build offers it where its catalog names it. */
export const planning = 'zippable-plan';
export const simulating = 'zippable-simulate';

/** The design with the parameters of what is made of it; the page always goes on from the parts to the ribbon. */
export function offered(catalog: Catalog): Operation | null {
  const operation = offeredTogether(catalog, design, [planning, simulating]);
  if (operation === null) return null;
  const { check_parts: _, ...properties } = operation.parameters.properties;
  return { ...operation, parameters: { properties } };
}

/** What was drawn, on which model, and as the operation reads it. */
export interface DrawnParts extends Drawn {
  readonly on: string;
  /** Null while nothing is whole. */
  readonly segments: BlobReference | null;
}

export interface ZippableDocument extends CraftDocument, RoomWithProducts {
  readonly drawn: DrawnParts | null;
}

export const zippable = new CraftCommands<ZippableDocument>('zippable', {
  ...emptyCraft,
  products: [],
  drawn: null,
});

/** What is drawn on the model in force. */
export function drawnOn({ model, drawn }: ZippableDocument): DrawnParts {
  const on = model?.mesh.blob ?? '';
  if (drawn?.on !== on) return { ...nothingDrawn, on, segments: null };
  // Projects of before there were cuts do not have all lists.
  return 'cuts' in drawn ? drawn : { ...nothingDrawn, ...(drawn as DrawnParts) };
}

export const setDrawn = (drawn: DrawnParts, label: string) =>
  zippable.command({ label }, () => ({ drawn }) as Partial<ZippableDocument>);

/** The design made with exactly these parameters, the model and the parts in force, if there is one. */
export function currentResult(
  { results }: CraftDocument,
  subject: Subject | null,
  parameters: JsonObject,
): CraftResult | null {
  if (subject === null) return null;
  const request = { mesh: subject.key, parameters };
  return results.find((result) => sameRequest(result, request)) ?? null;
}
