// SPDX-License-Identifier: GPL-3.0-or-later
// The bed of the chosen laser and the kerf in the chosen material, for what is laid out to be cut.
import type { Catalog, Json, JsonObject, Operation } from '../../jobs/contract';
import { findOperation } from '../../jobs/contract';
import type { LaserSheet } from '../../machines/laser_sheet';
import type { MachineProfile, ProfileStore } from '../../machines/profiles';
import { inForce, known } from '../../shared/session/craft_document';
import type { MachinesDocument } from './machines_document';
import { carriedOver, laserJob, operationFor } from './machines_document';

/** Nothing was opened or set here in this project: the machine is as its profile says. */
export const isUntouched = ({ drawing, parameters, set_aside }: MachinesDocument): boolean =>
  drawing === null && Object.keys(parameters).length === 0 && Object.keys(set_aside).length === 0;

/** Was the room set for another machine? Projects of before that was noted count as set for the one in use. */
export const isOfOther = ({ machine }: MachinesDocument, { id }: MachineProfile): boolean =>
  machine !== null && machine !== id;

/** The parameters of the laser's jobs in this project, whatever else its machines are doing. */
function laserParameters(document: MachinesDocument, catalog: Catalog, laser: Operation): JsonObject {
  const { drawing, parameters, set_aside } = document;
  const now = operationFor(drawing);
  if (now === laserJob) return parameters;
  const from = findOperation(catalog, now);
  const own = set_aside[laserJob] ?? {};
  return from ? carriedOver(from, parameters, laser, own) : own;
}

interface NamedMaterial {
  readonly name: string;
  readonly parameters: JsonObject;
}

/** The material that is chosen: the one all of whose values are in force. */
function chosenMaterial(
  { materials }: MachineProfile,
  { laser_materials }: Catalog,
  value: (name: string) => Json,
): NamedMaterial | undefined {
  const beginnings = (laser_materials?.materials ?? []).map(({ title, parameters }) => ({
    name: title,
    parameters,
  }));
  const isInForce = ({ parameters }: NamedMaterial) =>
    Object.entries(parameters).every(([name, set]) => value(name) === set);
  return [...materials, ...beginnings].find(isInForce);
}

/** Null until the catalog says what a laser is. */
export function laserSheet(
  profiles: ProfileStore,
  document: MachinesDocument,
  catalog: Catalog | null,
): LaserSheet | null {
  const operation = catalog && findOperation(catalog, laserJob);
  if (!catalog || !operation) return null;
  const profile = profiles.laser;
  const inUse = profile.id === profiles.current.id && !isUntouched(document) && !isOfOther(document, profile);
  const parameters = inUse
    ? laserParameters(document, catalog, operation)
    : known(operation, profile.parameters);
  const value = (name: string) => inForce(operation, parameters, name);
  const [bed_x_mm, bed_y_mm] = [value('bed_x_mm'), value('bed_y_mm')];
  if (typeof bed_x_mm !== 'number' || typeof bed_y_mm !== 'number') return null;
  const material = inUse ? chosenMaterial(profile, catalog, value) : undefined;
  const kerf_mm = material?.parameters['kerf_mm'];
  const kerf =
    typeof kerf_mm === 'number'
      ? { material: material?.name ?? null, kerf_mm }
      : { material: null, kerf_mm: null };
  return { laser: profile.name, bed_x_mm, bed_y_mm, ...kerf };
}
