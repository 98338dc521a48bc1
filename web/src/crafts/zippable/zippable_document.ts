// SPDX-License-Identifier: GPL-3.0-or-later
// The zippable's part of a project.
import type { Catalog, JsonObject, Operation } from '../../jobs/contract';
import type { LaserSheet } from '../../machines/laser_sheet';
import type { BlobReference } from '../../project/document';
import type { CraftDocument, CraftResult, Subject } from '../../shared/session/craft_document';
import { CraftCommands, emptyCraft, sameRequest } from '../../shared/session/craft_document';
import type { RoomWithProducts } from '../../shared/session/products';
import { offeredTogether } from '../../shared/session/products';
import type { Drawn } from './drawing/drawn_parts';
import { nothingDrawn } from './drawing/drawn_parts';
import type { SewnCheck } from './sewn/sewn_lengths';
import { leftToLaser, planning } from './sheet_size';

export { planning };

export const design = 'zippable-design';
/** What is made of a design; a build offers it where its catalog names it. */
export const simulating = 'zippable-simulate';

/** The design with the parameters of what is made of it; the page always goes on from the parts to the ribbon. */
export function offered(catalog: Catalog): Operation | null {
  const operation = offeredTogether(catalog, design, [planning, simulating]);
  if (operation === null) return null;
  const { check_parts: _, ...properties } = operation.parameters.properties;
  return leftToLaser({ ...operation, parameters: { properties } });
}

/** The group of parameters that a plan makes up for. */
export const errorsOfMaking = 'Errors of making';

/** Without what a plan makes up for: it leaves the cloth as it was designed. */
export const withoutErrors = (operation: Operation, parameters: JsonObject): JsonObject =>
  Object.fromEntries(
    Object.entries(parameters).filter(
      ([name]) => operation.parameters.properties[name]?.['x-group'] !== errorsOfMaking,
    ),
  );

/** What was drawn, on which model, and as the operation reads it. */
export interface DrawnParts extends Drawn {
  readonly on: string;
  /** Null while nothing is whole. */
  readonly segments: BlobReference | null;
}

export interface ZippableDocument extends CraftDocument, RoomWithProducts {
  readonly drawn: DrawnParts | null;
  /** The laser that the cutting plans were laid out for; null before the first one. */
  readonly laid_out_for: LaserSheet | null;
  /** Lengths of what was sewn; missing in projects of before these were measured. */
  readonly sewn?: SewnCheck | null;
}

export const zippable = new CraftCommands<ZippableDocument>('zippable', {
  ...emptyCraft,
  products: [],
  drawn: null,
  laid_out_for: null,
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

/** Plans are laid out for this laser from now on. Undone, they are laid out as before. */
export const layOutFor = (laser: LaserSheet, label: string) =>
  zippable.command({ label }, ({ parameters }) => {
    const { bed_x_mm: _x, bed_y_mm: _y, ...kept } = parameters;
    return { parameters: kept, laid_out_for: laser } as Partial<ZippableDocument>;
  });

/** The same where nobody asked for it: sizes that were set by hand stay. */
export const noteLaser = (laser: LaserSheet) =>
  zippable.command({ label: 'Lay out', recorded: false }, () => {
    return { laid_out_for: laser } as Partial<ZippableDocument>;
  });

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
