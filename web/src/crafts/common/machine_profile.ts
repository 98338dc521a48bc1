// SPDX-License-Identifier: GPL-3.0-or-later
// What is known of the machine that a project is made on: found in one room, used in another.
import type { JobInput, Json } from '../../jobs/contract';
import type { BlobReference, ProjectDocument } from '../../project/document';
import { isObject } from '../../project/document';
import type { Command } from '../../project/history';

export interface MachineProfile {
  /** As the profile calls itself. */
  readonly name: string;
  /** What it was made from, in words. */
  readonly from: string;
  readonly file: BlobReference;
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
