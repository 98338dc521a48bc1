// SPDX-License-Identifier: GPL-3.0-or-later
// What is known of the machine that a project is made on: found in one room, used in another.
import type { JobInput, Json, JsonObject, Operation } from '../../jobs/contract';
import type { BlobReference, ProjectDocument } from '../../project/document';
import { isObject } from '../../project/document';
import type { Command } from '../../project/history';

export interface MachineProfile {
  /** As the profile calls itself. */
  readonly name: string;
  /** What it was made from, in words. */
  readonly from: string;
  readonly file: BlobReference;
  /** What takes the place of an operation's defaults: its `parameters`. */
  readonly parameters?: JsonObject;
}

interface MachineDocument {
  readonly profile: MachineProfile | null;
}

const place = 'machine';

function set(profile: MachineProfile | null, label: string): Command<ProjectDocument> {
  const after = { profile } as unknown as Json;
  return { label, apply: (document) => ({ ...document, crafts: { ...document.crafts, [place]: after } }) };
}

export const machineProfile = {
  of({ crafts }: ProjectDocument): MachineDocument {
    const stored = crafts[place];
    return isObject(stored) ? (stored as unknown as MachineDocument) : { profile: null };
  },
  use: (profile: MachineProfile) => set(profile, `Use ${profile.name}`),
  remove: () => set(null, 'Use no machine profile'),
};

/** For the operations that take a profile. */
export const profileInputs = (profile: MachineProfile | null): Readonly<Record<string, JobInput>> =>
  profile ? { profile: { sha256: profile.file.blob, file_name: 'profile.json' } } : {};

/** An operation that takes the profile, with the values that hold where nothing else is said. */
export function withProfile(operation: Operation, profile: MachineProfile | null): Operation {
  const said = profile?.parameters ?? {};
  if (!operation.inputs.some(({ name }) => name === 'profile')) return operation;
  const properties = Object.fromEntries(
    Object.entries(operation.parameters.properties).map(([name, schema]) => {
      const value = said[name];
      return [name, value === undefined ? schema : { ...schema, default: value }];
    }),
  );
  return profile ? { ...operation, parameters: { ...operation.parameters, properties } } : operation;
}
