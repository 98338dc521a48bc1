// SPDX-License-Identifier: GPL-3.0-or-later
// Evidence's part of a project: measured objects, what each is used for, and what was found with them.
import type { JobInput, Json, JsonObject, Report } from '../../jobs/contract';
import type { BlobReference } from '../../project/document';
import type { CraftResult, RoomDocument, Subject } from '../../shared/session/craft_document';
import { emptyRoom, RoomCommands } from '../../shared/session/craft_document';
import type { ByHand } from './by_hand/hand_marks';

export const diagnosing = 'evidence-diagnose';
const calibrating = 'evidence-calibrate';
export const comparing = 'thermoform-compare';
export const inventing = 'evidence-virtual-object';
export const registering = 'evidence-register';
export const photographing = 'evidence-photographs';
export const planning = 'evidence-plan-points';

export type Mode = 'diagnose' | 'calibrate';
/** `unseen`: only to measure the gain on. `good`: from when the machine was in order. */
export type Use = 'fit' | 'unseen' | 'good' | 'off';

export const objectFiles = ['mould.obj', 'setup.json', 'measured.csv'] as const;
export type ObjectFile = (typeof objectFiles)[number];

export interface MeasuredObject {
  readonly id: string;
  readonly name: string;
  /** The three files as one archive, as the operations take them. */
  readonly pack: BlobReference;
  readonly files: Readonly<Record<ObjectFile, BlobReference>>;
  readonly points: number;
  /** Number of thickness readings; missing in projects kept before these were read. */
  readonly thickness?: number;
  readonly use: Use;
}

/** Files of an object that is not complete yet. */
interface Draft {
  readonly name: string;
  readonly files: Readonly<Partial<Record<ObjectFile, BlobReference>>>;
}

/** A scan of a printed sheet, or photographs of it, on the way to measured points. */
export interface Scan {
  /** What measures it; missing in projects kept before photographs were: a scan. */
  readonly operation?: typeof registering | typeof photographing;
  readonly files: readonly {
    readonly input: string;
    readonly file_name: string;
    readonly file: BlobReference;
  }[];
  /** Where the maker put the four marks, in pixels of the picture; null: as they are found. */
  readonly corners: readonly Place[] | null;
  /** Of its measuring; only what differs from the defaults. */
  readonly parameters: JsonObject;
  readonly measured: MeasuredScan | null;
}

export type Place = readonly [x_px: number, y_px: number];

/** What a scan was measured to be. */
export interface MeasuredScan {
  /** The request it answers. */
  readonly of: Json;
  readonly report: Report;
  readonly points: BlobReference;
  /** The scan mapped back to the flat sheet; of photographs the marks that were seen. */
  readonly aligned: BlobReference;
}

export interface EvidenceDocument extends RoomDocument {
  readonly mode: Mode;
  readonly objects: readonly MeasuredObject[];
  readonly draft: Draft | null;
  readonly scan: Scan | null;
  readonly byHand: ByHand | null;
}

export const emptyEvidence: EvidenceDocument = {
  ...emptyRoom,
  mode: 'diagnose',
  objects: [],
  draft: null,
  scan: null,
  byHand: null,
};

export const operationOf = (mode: Mode): string => (mode === 'diagnose' ? diagnosing : calibrating);

const used = (objects: readonly MeasuredObject[], use: Use) => objects.filter((object) => object.use === use);

const numbered = (name: string, objects: readonly MeasuredObject[]): [string, JobInput][] =>
  objects.map((object, i) => [
    i === 0 ? name : `${name}_${i + 1}`,
    { sha256: object.pack.blob, file_name: `${object.name}.zip` },
  ]);

/** What a run is about; null while no object is fitted. */
export function subjectOf({ mode, objects }: Pick<EvidenceDocument, 'mode' | 'objects'>): Subject | null {
  const fit = used(objects, 'fit');
  const beside = (use: Use) => (mode === 'diagnose' ? used(objects, use) : []);
  const [unseen, good] = [beside('unseen'), beside('good')];
  if (fit.length === 0) return null;
  const hashes = (list: readonly MeasuredObject[]) => list.map(({ pack }) => pack.blob).join('+');
  return {
    // Without a good part as in projects kept before there were any.
    key: [operationOf(mode), hashes(fit), hashes(unseen), ...(good.length > 0 ? [hashes(good)] : [])].join(
      ' ',
    ),
    inputs: Object.fromEntries([
      ...numbered('object', fit),
      ...numbered('unseen', unseen),
      ...numbered('good', good),
    ]),
  };
}

/** What a result used each object for; objects that came later are off. Null where one of them is gone. */
export function usesIn(
  key: string,
  objects: readonly MeasuredObject[],
): { readonly mode: Mode; readonly objects: readonly MeasuredObject[] } | null {
  const [operation = '', ...lists] = key.split(' ');
  const uses: readonly Use[] = ['fit', 'unseen', 'good'];
  const useOfHash = new Map(
    uses.flatMap((use, i) =>
      (lists[i] ?? '')
        .split('+')
        .filter(Boolean)
        .map((hash) => [hash, use] as const),
    ),
  );
  const known = new Set(objects.map(({ pack }) => pack.blob));
  if (![...useOfHash.keys()].every((hash) => known.has(hash))) return null;
  const useOf = ({ pack }: MeasuredObject): Use => useOfHash.get(pack.blob) ?? 'off';
  return {
    mode: operation === diagnosing ? 'diagnose' : 'calibrate',
    objects: objects.map((object) => ({ ...object, use: useOf(object) })),
  };
}

/** "lamp", "lamp 2", ...; "Object 1", "Object 2", ...: names tell objects apart in tables and reports. */
export function freeName(wanted: string, objects: readonly MeasuredObject[]): string {
  const plain = wanted.replaceAll(/[,"\r\n]/g, '_').trim() || 'Object';
  const taken = new Set(objects.map(({ name }) => name));
  for (let number = 1; ; ++number) {
    const name = number === 1 ? plain : `${plain.replace(/ 1$/, '')} ${number}`;
    if (!taken.has(name)) return name;
  }
}

class EvidenceCommands extends RoomCommands<EvidenceDocument> {
  addObject(object: MeasuredObject) {
    return this.command({ label: `Add ${object.name}` }, ({ objects }) => ({
      objects: [...objects, object],
      draft: null,
    }));
  }

  removeObject({ id, name }: MeasuredObject) {
    return this.command({ label: `Remove ${name}` }, ({ objects }) => ({
      objects: objects.filter((object) => object.id !== id),
    }));
  }

  useObject({ id, name }: MeasuredObject, use: Use) {
    return this.command({ label: `Change what ${name} is used for` }, ({ objects }) => ({
      objects: objects.map((object) => (object.id === id ? { ...object, use } : object)),
    }));
  }

  setMode(mode: Mode) {
    return this.command({ label: 'Choose between diagnosis and calibration', recorded: false }, () => ({
      mode,
    }));
  }

  setDraft(draft: Draft | null, label: string) {
    return this.command({ label }, () => ({ draft }));
  }

  setScan(scan: Scan | null, label: string) {
    return this.command({ label }, () => ({ scan }));
  }

  changeScan(change: Partial<Scan>, label: string, coalesce?: string) {
    return this.command({ label, ...(coalesce ? { coalesce } : {}) }, ({ scan }) => ({
      scan: scan && { ...scan, ...change },
    }));
  }

  keepMeasuredScan(measured: MeasuredScan) {
    return this.command({ label: 'Measure the scan', recorded: false }, ({ scan }) => ({
      scan: scan && { ...scan, measured },
    }));
  }

  setByHand(byHand: ByHand | null, label: string) {
    return this.command({ label }, () => ({ byHand }));
  }

  changeByHand(change: Partial<ByHand>, label: string, coalesce?: string) {
    return this.command({ label, ...(coalesce ? { coalesce } : {}) }, ({ byHand }) => ({
      byHand: byHand && { ...byHand, ...change },
    }));
  }

  returnTo(result: CraftResult, label: string) {
    return this.command({ label }, ({ objects }) => ({
      ...usesIn(result.mesh, objects),
      parameters: result.parameters,
    }));
  }
}

export const evidence = new EvidenceCommands('evidence', emptyEvidence);
