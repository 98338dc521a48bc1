// SPDX-License-Identifier: GPL-3.0-or-later
// What a craft keeps in a project: a model, parameters, results; and the commands that change it.
import type { JobInput, Json, JsonObject, Operation, Report } from '../../jobs/contract';
import type { BlobReference, ProjectDocument } from '../../project/document';
import { isObject, jsonEqual } from '../../project/document';
import type { Command } from '../../project/history';

/** A file that came with the model: its materials or its picture. */
export interface Companion {
  readonly file_name: string;
  readonly file: BlobReference;
}

interface FileSource {
  readonly kind: 'file';
  readonly file_name: string;
  readonly file: BlobReference;
  readonly companions?: readonly Companion[];
}

interface SampleSource {
  readonly kind: 'sample';
  readonly sample: string;
  readonly title: string;
}

export type SingleSource = FileSource | SampleSource;

/** One of several models, as the operation `combine` puts it to its place. */
export interface PlacedModel {
  readonly source: SingleSource;
  readonly name: string;
  /** The longest side of its box, before it is turned. */
  readonly size_mm: number;
  /** About x first, then y, then z. */
  readonly turn_deg: readonly [number, number, number];
  /** The middle of its box as it stands. */
  readonly at_mm: readonly [number, number, number];
}

/** Several models made one. */
export interface GroupSource {
  readonly kind: 'group';
  readonly title: string;
  readonly models: readonly PlacedModel[];
}

export type Source = SingleSource | GroupSource;

export interface CraftModel {
  readonly source: Source;
  /** Repaired, as `import` wrote it. */
  readonly mesh: BlobReference;
  /** For live previews; the mesh itself where that is small enough. */
  readonly preview: BlobReference;
  readonly report: Report;
  /** Its own picture, which the mesh says where to place; not there where it has none or several. */
  readonly picture?: BlobReference;
}

export interface CraftResult {
  readonly id: string;
  readonly made_unix_s: number;
  readonly backend: string;
  /** From the button to the result. */
  readonly seconds: number;
  /** What it was made from: the subject's key. */
  readonly mesh: string;
  readonly parameters: JsonObject;
  readonly report: Report;
  readonly outputs: Readonly<Record<string, BlobReference>>;
  readonly picture?: BlobReference;
  /** The worker's name for it, under which it keeps the other formats. */
  readonly job?: string;
}

/** A full solve handed to the worker, to be found again after a reload. */
export interface PendingSolve {
  readonly job: string;
  readonly mesh: string;
  readonly parameters: JsonObject;
}

/** What every room keeps. */
export interface RoomDocument {
  /** Only what differs from the defaults. */
  readonly parameters: JsonObject;
  /** Newest first. */
  readonly results: readonly CraftResult[];
  readonly pending: PendingSolve | null;
}

/** What a room keeps that makes something of a model. */
export interface CraftDocument extends RoomDocument {
  readonly model: CraftModel | null;
}

export const emptyRoom: RoomDocument = { parameters: {}, results: [], pending: null };
export const emptyCraft: CraftDocument = { model: null, ...emptyRoom };
const keptResults = 12;

/** Reads and changes the part of a project that belongs to one craft; `empty` is what a new project has. */
export class RoomCommands<D extends RoomDocument> {
  readonly craft: string;
  readonly #empty: D;

  constructor(craft: string, empty: D) {
    this.craft = craft;
    this.#empty = empty;
  }

  of(document: ProjectDocument): D {
    const stored = document.crafts[this.craft];
    return isObject(stored) ? { ...this.#empty, ...(stored as unknown as Partial<D>) } : this.#empty;
  }

  command(
    rest: Omit<Command<ProjectDocument>, 'apply'>,
    change: (craft: D) => Partial<D> | Partial<RoomDocument>,
  ): Command<ProjectDocument> {
    const apply = (document: ProjectDocument): ProjectDocument => {
      const before = this.of(document);
      const after = { ...before, ...change(before) } as unknown as Json;
      return { ...document, crafts: { ...document.crafts, [this.craft]: after } };
    };
    return { ...rest, apply };
  }

  setParameters(operation: Operation, values: JsonObject, label: string, coalesce?: string) {
    return this.command({ label, ...(coalesce ? { coalesce } : {}) }, ({ parameters }) => {
      return { parameters: withoutDefaults(operation, { ...parameters, ...values }) };
    });
  }

  /** `names`: the parameters that the result speaks of; others stay. */
  restoreResult(result: CraftResult, label: string, names: (name: string) => boolean = () => true) {
    return this.command({ label }, ({ parameters }) => {
      const kept = Object.fromEntries(Object.entries(parameters).filter(([name]) => !names(name)));
      return { parameters: { ...kept, ...result.parameters } };
    });
  }

  addResult(result: CraftResult) {
    return this.command({ label: 'Solve', recorded: false }, ({ results }) => {
      return { pending: null, results: withResult(results, result) };
    });
  }

  /** More about a result that is there already: another format, its picture. */
  amendResult(id: string, change: (result: CraftResult) => CraftResult) {
    return this.command({ label: 'Solve', recorded: false }, ({ results }) => {
      return { results: results.map((old) => (old.id === id ? change(old) : old)) };
    });
  }

  removeResult(id: string) {
    return this.command({ label: 'Delete a result' }, ({ results }) => {
      return { results: results.filter((result) => result.id !== id) };
    });
  }

  setPending(pending: PendingSolve | null) {
    return this.command({ label: 'Solve', recorded: false }, () => ({ pending }));
  }
}

export class CraftCommands<D extends CraftDocument> extends RoomCommands<D> {
  /** `own`: what the new model says of itself. Parameters of the `forgotten` kind belonged to the old one. */
  openModel(
    operation: Operation,
    model: CraftModel,
    label: string,
    own: JsonObject,
    forgotten: (name: string) => boolean,
  ) {
    return this.command({ label }, ({ parameters }) => {
      const kept = Object.fromEntries(Object.entries(parameters).filter(([name]) => !forgotten(name)));
      const opened: Partial<CraftDocument> = {
        model,
        parameters: withoutDefaults(operation, { ...kept, ...own }),
      };
      return opened;
    });
  }

  /** The same model, otherwise placed or with more beside it. */
  changeModel(model: CraftModel, label: string, also: (craft: D) => Partial<D> = () => ({})) {
    return this.command({ label }, (craft) => ({ ...craft, ...also(craft), model }));
  }
}

/** The newest first, one of each request. */
export const withResult = <R extends SolveRequest>(results: readonly R[], made: R): R[] =>
  [made, ...results.filter((old) => !sameRequest(old, made))].slice(0, keptResults);

export const nameProject = (name: string): Command<ProjectDocument> => ({
  label: 'Name the project',
  recorded: false,
  apply: (document) => ({ ...document, name }),
});

export function withoutDefaults(operation: Operation, values: JsonObject): JsonObject {
  const schema = operation.parameters.properties;
  return Object.fromEntries(
    Object.entries(values).filter(([name, value]) => !jsonEqual(value, schema[name]?.default ?? null)),
  );
}

/** Those of the parameters that an operation knows. */
export const known = (operation: Operation | undefined, parameters: JsonObject): JsonObject =>
  Object.fromEntries(
    Object.entries(parameters).filter(([name]) => operation && name in operation.parameters.properties),
  );

/** The value in force: as set, or the operation's default. */
export const inForce = (operation: Operation, parameters: JsonObject, name: string): Json =>
  parameters[name] ?? operation.parameters.properties[name]?.default ?? null;

export type SolveRequest = Pick<CraftResult, 'mesh' | 'parameters'>;

export const sameRequest = (a: SolveRequest, b: SolveRequest) =>
  a.mesh === b.mesh && jsonEqual(a.parameters, b.parameters);

/** What a solve is about: the inputs of its job, and a name by which equal ones are known. */
export interface Subject {
  readonly key: string;
  readonly inputs: Readonly<Record<string, JobInput>>;
}

/** A mesh and what comes with it; the mesh alone is known by its hash. */
export function subjectOf(
  mesh: BlobReference,
  name: string,
  further: Readonly<Record<string, JobInput>>,
): Subject {
  const hashes = Object.values(further).map((input) => ('sha256' in input ? input.sha256 : input.sample));
  return {
    key: [mesh.blob, ...hashes].join('+'),
    inputs: { [name]: meshInput(mesh, 'model.ply'), ...further },
  };
}

/** Names a solve: equal keys, equal results. */
export const requestKey = (mesh: string, parameters: JsonObject): Json => ({ mesh, parameters });

export const meshInput = (mesh: BlobReference, name: string): JobInput => ({
  sha256: mesh.blob,
  file_name: name,
});

export const titleOf = (source: Source): string => (source.kind === 'file' ? source.file_name : source.title);

/** The models of a project's other rooms, each once, by the hash of its mesh. */
export function modelsElsewhere({ crafts }: ProjectDocument, craft: string): CraftModel[] {
  const found = new Map<string, CraftModel>();
  for (const [name, room] of Object.entries(crafts)) {
    if (name === craft || !isObject(room) || !isObject(room['model'])) continue;
    const model = room['model'] as unknown as Partial<CraftModel>;
    if (model.mesh && model.preview && model.source && model.report)
      found.set(model.mesh.blob, model as CraftModel);
  }
  return [...found.values()];
}
