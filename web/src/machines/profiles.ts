// SPDX-License-Identifier: GPL-3.0-or-later
// Machines that a person has: what is known of each, kept in the browser and shared as a file.
import { signal } from '@preact/signals';
import type { Json, JsonObject } from '../jobs/contract';
import { jsonEqual } from '../project/document';

export const profileExtension = 'formwright-machine.json';

interface Material {
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

/** One of the two that everybody has, for machines on the screen. */
export const isPractice = ({ id }: MachineProfile): boolean =>
  id === practiceLaser.id || id === practiceMill.id;

export const isMill = ({ options }: MachineProfile): boolean => options['tool'] === 'mill';
const isLaser = ({ options }: MachineProfile): boolean => (options['tool'] ?? 'laser') === 'laser';

interface Kept {
  readonly profiles: readonly MachineProfile[];
  readonly chosen: string | null;
  readonly recent: readonly string[];
}

/** So many machines are remembered in the order of their use. */
const keptRecent = 16;

/** What a tab has stored, or null where there is nothing to be read. */
function asKept(text: string | null): Kept | null {
  let stored: unknown = null;
  try {
    stored = JSON.parse(text ?? 'null');
  } catch {
    // Damaged storage: as if there were none.
  }
  if (!isObject(stored) || !Array.isArray(stored['profiles'])) return null;
  const profiles = stored['profiles'].flatMap((profile: unknown) => {
    try {
      return [asProfile(profile)];
    } catch {
      return [];
    }
  });
  const chosen = typeof stored['chosen'] === 'string' ? stored['chosen'] : null;
  const recent = Array.isArray(stored['recent']) ? stored['recent'] : [];
  return { profiles, chosen, recent: recent.filter((id) => typeof id === 'string').slice(0, keptRecent) };
}

type Edit = (all: readonly MachineProfile[]) => readonly MachineProfile[];

/** The machines, the one in use, and where both are kept. Tabs share the machines; each has its own in use. */
export class ProfileStore {
  readonly #storage: Pick<Storage, 'getItem' | 'setItem'>;
  /** What this tab changed and storage has not taken. */
  #unsaved: Edit[] = [];
  readonly profiles = signal<readonly MachineProfile[]>([practiceLaser, practiceMill]);
  readonly chosen = signal<string>(practiceLaser.id);
  /** Ids of machines that were in use, the last one first. */
  readonly #recent = signal<readonly string[]>([]);

  constructor(
    storage: Pick<Storage, 'getItem' | 'setItem'>,
    tabs: Partial<Pick<EventTarget, 'addEventListener'>> = globalThis,
  ) {
    this.#storage = storage;
    const stored = this.#stored();
    if (stored !== null && stored.profiles.length > 0) this.profiles.value = stored.profiles;
    if (stored?.chosen) this.chosen.value = stored.chosen;
    if (stored !== null) this.#recent.value = stored.recent;
    tabs.addEventListener?.('storage', (event) => {
      if ((event as StorageEvent).key === key) this.#catchUp();
    });
  }

  get current(): MachineProfile {
    const { value: all } = this.profiles;
    return all.find(({ id }) => id === this.chosen.value) ?? all[0] ?? practiceLaser;
  }

  /** One that carves, or one that does not: the one in use, else the last that was, else the first there is. */
  oneThat(carves: boolean): MachineProfile {
    return this.#lastUsed((profile) => isMill(profile) === carves) ?? (carves ? practiceMill : practiceLaser);
  }

  /** The laser in use; while another machine is, the last laser that was, else the first there is. */
  get laser(): MachineProfile {
    return this.#lastUsed(isLaser) ?? practiceLaser;
  }

  #lastUsed(isIt: (profile: MachineProfile) => boolean): MachineProfile | undefined {
    const { value: all } = this.profiles;
    const before = this.#recent.value.flatMap((id) => all.find((profile) => profile.id === id) ?? []);
    return [this.current, ...before, ...all].find(isIt);
  }

  choose(id: string): void {
    this.#use(id);
    this.#change((all) => all);
  }
  #use(id: string): void {
    const others = [this.current.id, ...this.#recent.value].filter((other) => other !== id);
    this.#recent.value = [id, ...new Set(others)].slice(0, keptRecent);
    this.chosen.value = id;
  }
  /** Adds the machine, or changes the one with its id; it is in use then. */
  put(profile: MachineProfile): void {
    const known = this.profiles.value.find(({ id }) => id === profile.id);
    if (known && jsonEqual(known as unknown as Json, profile as unknown as Json))
      return this.choose(profile.id); // another tab may know more of it
    this.#use(profile.id);
    this.#change((all) =>
      all.some(({ id }) => id === profile.id)
        ? all.map((old) => (old.id === profile.id ? profile : old))
        : [...all, profile],
    );
  }
  remove(id: string): void {
    this.#change((all) => {
      const rest = all.filter((profile) => profile.id !== id);
      return rest.length > 0 ? rest : [practiceLaser];
    });
    this.choose(this.profiles.value[0]?.id ?? practiceLaser.id);
  }

  #stored(): Kept | null {
    try {
      return asKept(this.#storage.getItem(key));
    } catch {
      return null; // no storage: the machines last as long as the page
    }
  }
  /** Takes up what other tabs wrote, with what this one changed over it. The machine in use here stays, also
   *  when another tab removed it: a job may be under way on it. */
  #catchUp(): void {
    const stored = this.#stored();
    if (stored === null || stored.profiles.length === 0) return;
    const all = this.#unsaved.reduce((before, edit) => edit(before), stored.profiles);
    const inUse = this.profiles.value.find(({ id }) => id === this.chosen.value);
    const isGone = inUse !== undefined && all.every(({ id }) => id !== inUse.id);
    this.profiles.value = isGone ? [...all, inUse] : all;
  }
  /** Every tab writes all machines: what others wrote is read again first. */
  #change(edit: Edit): void {
    this.#catchUp();
    this.profiles.value = edit(this.profiles.value);
    this.#unsaved.push(edit);
    const profiles = this.profiles.value.map((profile) => ({ format, version: 1, ...profile }));
    try {
      this.#storage.setItem(
        key,
        JSON.stringify({ profiles, chosen: this.chosen.value, recent: this.#recent.value }),
      );
      this.#unsaved = [];
    } catch {
      // No room: they are written with the next change that fits.
    }
  }
}
