// SPDX-License-Identifier: GPL-3.0-or-later
// How large the sheets are: as set by hand, else as the laser's bed. What was laid out for a laser stays as it is.
import type { Json, JsonObject, Operation } from '../../jobs/contract';
import type { LaserSheet } from '../../machines/laser_sheet';
import type { Product } from '../../shared/session/products';
import { known, withoutDefaults } from '../../shared/session/craft_document';

/** Makes cutting plans of a design; a build offers it where its catalog names it. */
export const planning = 'zippable-plan';
const sizes = ['bed_x_mm', 'bed_y_mm'] as const;
/** Of the laser, unless they are set by hand. */
const leftOpen: readonly string[] = [...sizes, 'kerf_mm'];

/** The operation with these parameters optional: null is "as the laser". So a size that is set by hand stays
 *  set by hand where it happens to be the usual one. */
export function leftToLaser(operation: Operation): Operation {
  const properties = Object.fromEntries(
    Object.entries(operation.parameters.properties).map(([name, schema]) => [
      name,
      leftOpen.includes(name) ? { ...schema, type: ['number', 'null'], default: null } : schema,
    ]),
  );
  return { ...operation, parameters: { ...operation.parameters, properties } };
}

export interface LaidOut {
  readonly parameters: JsonObject;
  readonly products: readonly Product[];
  readonly laid_out_for: LaserSheet | null;
}

/** Does the project have a cutting plan? Then it is not to change by itself. */
export const hasPlan = ({ products, laid_out_for }: LaidOut): boolean =>
  laid_out_for !== null || products.some(({ operation }) => operation === planning);

/** The laser that plans are laid out for: the one that they were, else the chosen one. Null: the operation's own sizes count, as in
 *  projects that were laid out before lasers were asked. */
export const laserOf = (project: LaidOut, chosen: LaserSheet | null): LaserSheet | null =>
  project.laid_out_for ?? (hasPlan(project) ? null : chosen);

/** What the laser says, by the names of the plan's parameters. */
const saidBy = (laser: LaserSheet | null): JsonObject =>
  laser === null
    ? {}
    : {
        bed_x_mm: laser.bed_x_mm,
        bed_y_mm: laser.bed_y_mm,
        ...(laser.kerf_mm === null ? {} : { kerf_mm: laser.kerf_mm }),
      };

/** The plan's parameters in force: only what differs from `operation`'s defaults, as results are known by. */
export function planParameters(
  operation: Operation,
  project: LaidOut,
  chosen: LaserSheet | null,
): JsonObject {
  const said = saidBy(laserOf(project, chosen));
  return withoutDefaults(operation, known(operation, { ...said, ...project.parameters }));
}

/** Values that the maker left open, as they come out: for the controls. */
export function automaticSizes(
  operation: Operation,
  project: LaidOut,
  chosen: LaserSheet | null,
): Record<string, number> {
  const said = saidBy(laserOf(project, chosen));
  const values = leftOpen.map((name): [string, Json] => [
    name,
    said[name] ?? operation.parameters.properties[name]?.default ?? null,
  ]);
  return Object.fromEntries(
    values.filter((value): value is [string, number] => typeof value[1] === 'number'),
  );
}

/** Is the size of the sheets set by hand? */
export const isSetByHand = ({ parameters }: LaidOut): boolean =>
  sizes.some((name) => typeof parameters[name] === 'number');
