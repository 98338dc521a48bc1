// SPDX-License-Identifier: GPL-3.0-or-later
// Machines that a person has: what is known of each, kept in the browser and shared as a file.
import { signal } from '@preact/signals';
import type { Json, JsonObject } from '../jobs/contract';

export const profileExtension = 'formwright-machine.json';

export interface Material {
  readonly name: string;
  /** Values of the job's parameters: power, speed, passes, kerf. */
  readonly parameters: JsonObject;
}

export interface MachineProfile {
  readonly id: string;
  readonly name: string;
  /** For the driver: controller, tool, line speed. */
  readonly options: JsonObject;
  /** Of jobs for this machine: bed, origin, speeds; only what differs from the defaults. */
  readonly parameters: JsonObject;
  readonly materials: readonly Material[];
}

const key = 'formwright.machines';
const format = 'formwright-machine';

const isObject = (value: unknown): value is Record<string, unknown> =>
  typeof value === 'object' && value !== null && !Array.isArray(value);
const isValue = (value: unknown): value is Json =>
  value === null ||
  ['string', 'boolean'].includes(typeof value) ||
  (typeof value === 'number' && Number.isFinite(value)) ||
  (Array.isArray(value) &&
    value.length <= 16 &&
    value.every((item) => typeof item === 'number' && Number.isFinite(item)));

function values(value: unknown, what: string): JsonObject {
  if (!isObject(value) || Object.keys(value).length > 200 || !Object.values(value).every(isValue))
    throw new Error(`The machine's ${what} are damaged: export the profile again.`);
  return value as JsonObject;
}

function text(value: unknown, what: string): string {
  if (typeof value !== 'string' || value.trim() === '' || value.length > 80)
    throw new Error(`The machine's ${what} is missing or too long: export the profile again.`);
  return value.trim();
}

/** Checks what comes from a file or from storage. Throws Error with one sentence. */
export function asProfile(value: unknown): MachineProfile {
  if (!isObject(value) || value['format'] !== format)
    throw new Error('This is not a machine profile: choose a file that was exported here.');
  if (value['version'] !== 1)
    throw new Error('This profile was made by a newer Formwright: update the page to read it.');
  const materials = value['materials'] ?? [];
  if (!Array.isArray(materials) || materials.length > 500)
    throw new Error("The machine's materials are damaged: export the profile again.");
  return {
    id: typeof value['id'] === 'string' ? value['id'] : crypto.randomUUID(),
    name: text(value['name'], 'name'),
    options: values(value['options'], 'options'),
    parameters: values(value['parameters'], 'parameters'),
    materials: materials.map((material: unknown) => ({
      name: text(isObject(material) ? material['name'] : null, 'material name'),
      parameters: values(isObject(material) ? material['parameters'] : null, 'materials'),
    })),
  };
}

export const profileFile = (profile: MachineProfile): string =>
  `${JSON.stringify({ format, version: 1, ...profile }, null, 2)}\n`;

export const practiceLaser: MachineProfile = {
  id: 'practice',
  name: 'Practice laser',
  options: { controller: 'grbl', tool: 'laser' },
  parameters: {},
  materials: [],
};

export const practiceMill: MachineProfile = {
  id: 'practice-mill',
  name: 'Practice mill',
  options: { controller: 'grbl', tool: 'mill' },
  parameters: { controller: 'grbl_mill', bed_x_mm: 300, bed_y_mm: 200 },
  materials: [],
};

export const isMill = ({ options }: MachineProfile): boolean => options['tool'] === 'mill';

/** The machines, the one in use, and where both are kept. */
export class ProfileStore {
  readonly #storage: Pick<Storage, 'getItem' | 'setItem'>;
  readonly profiles = signal<readonly MachineProfile[]>([practiceLaser, practiceMill]);
  readonly chosen = signal<string>(practiceLaser.id);

  constructor(storage: Pick<Storage, 'getItem' | 'setItem'>) {
    this.#storage = storage;
    try {
      const stored: unknown = JSON.parse(storage.getItem(key) ?? 'null');
      if (isObject(stored) && Array.isArray(stored['profiles'])) {
        const read = stored['profiles'].flatMap((profile: unknown) => {
          try {
            return [asProfile(profile)];
          } catch {
            return [];
          }
        });
        if (read.length > 0) this.profiles.value = read;
        if (typeof stored['chosen'] === 'string') this.chosen.value = stored['chosen'];
      }
    } catch {
      // Damaged storage: the practice laser is there again.
    }
  }

  get current(): MachineProfile {
    const { value: all } = this.profiles;
    return all.find(({ id }) => id === this.chosen.value) ?? all[0] ?? practiceLaser;
  }

  /** One that carves, or one that does not: the one in use, else the first there is. */
  oneThat(carves: boolean): MachineProfile {
    const isIt = (profile: MachineProfile) => isMill(profile) === carves;
    return [this.current, ...this.profiles.value].find(isIt) ?? (carves ? practiceMill : practiceLaser);
  }

  choose(id: string): void {
    this.chosen.value = id;
    this.#save();
  }
  /** Adds the machine, or changes the one with its id; it is in use then. */
  put(profile: MachineProfile): void {
    const others = this.profiles.value;
    this.profiles.value = others.some(({ id }) => id === profile.id)
      ? others.map((old) => (old.id === profile.id ? profile : old))
      : [...others, profile];
    this.choose(profile.id);
  }
  remove(id: string): void {
    const rest = this.profiles.value.filter((profile) => profile.id !== id);
    this.profiles.value = rest.length > 0 ? rest : [practiceLaser];
    this.choose(this.profiles.value[0]?.id ?? practiceLaser.id);
  }

  #save(): void {
    const profiles = this.profiles.value.map((profile) => ({ format, version: 1, ...profile }));
    try {
      this.#storage.setItem(key, JSON.stringify({ profiles, chosen: this.chosen.value }));
    } catch {
      // No room: the machines last as long as the page.
    }
  }
}
