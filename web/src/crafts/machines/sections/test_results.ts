// SPDX-License-Identifier: GPL-3.0-or-later
// What a test on material tells the jobs to come.
import type { JsonObject, Operation, Report } from '../../../jobs/contract';
import type { MachineProfile } from '../../../machines/profiles';
import { inForce } from '../../../shared/session/craft_document';

/** A square or line of a test, as the report tells it: its lower left corner on the bed. */
export interface TestCell {
  readonly name: string;
  readonly power_percent: number;
  readonly speed_mm_per_s: number;
  readonly z_mm: number;
  readonly x_mm: number;
  readonly y_mm: number;
}

const materialGroups = ['Cut', 'Mark', 'Engrave', 'Cutting'];

/** Parameters that belong to a material rather than to a drawing or a machine. */
export const materialNames = (laser: Operation | null): string[] =>
  Object.entries(laser?.parameters.properties ?? {})
    .filter(([, schema]) => materialGroups.includes(schema['x-group'] ?? ''))
    .map(([name]) => name);

const isCell = (value: unknown): value is TestCell =>
  typeof value === 'object' &&
  value !== null &&
  'name' in value &&
  'power_percent' in value &&
  'speed_mm_per_s' in value;

export const cellsOf = ({ cells }: Report): TestCell[] =>
  Array.isArray(cells) ? (cells as readonly unknown[]).filter(isCell) : [];

/** The square under a place of the bed. */
export const cellAt = (
  cells: readonly TestCell[],
  side_mm: number,
  x_mm: number,
  y_mm: number,
): TestCell | undefined =>
  cells.find(
    (cell) =>
      x_mm >= cell.x_mm && x_mm <= cell.x_mm + side_mm && y_mm >= cell.y_mm && y_mm <= cell.y_mm + side_mm,
  );

/** The layers that a square can set, and the names of their parameters. */
export const layers = ['cut', 'mark', 'engrave'] as const;
export type Layer = (typeof layers)[number];

export const settingsOf = (cell: TestCell, layer: Layer, passes: number): JsonObject => ({
  [`${layer}_power_percent`]: cell.power_percent,
  [`${layer}_speed_mm_per_s`]: cell.speed_mm_per_s,
  [`${layer}_passes`]: passes,
});

/** The kept material that is in force. */
export const materialInForce = (profile: MachineProfile, laser: Operation, parameters: JsonObject) =>
  profile.materials.find((material) =>
    Object.entries(material.parameters).every(([name, value]) => inForce(laser, parameters, name) === value),
  );

/** The profile in which the material in force has what was found out; null where none is in force. */
export function profileWith(
  profile: MachineProfile,
  laser: Operation,
  parameters: JsonObject,
  found: JsonObject,
): MachineProfile | null {
  const chosen = materialInForce(profile, laser, parameters);
  if (chosen === undefined) return null;
  const materials = profile.materials.map((material) =>
    material === chosen ? { ...material, parameters: { ...material.parameters, ...found } } : material,
  );
  return { ...profile, materials };
}
