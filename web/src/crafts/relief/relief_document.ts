// SPDX-License-Identifier: GPL-3.0-or-later
// What the relief keeps in a project, and the commands that change it.
import type { JobInput, Json, JsonObject, Operation, Report } from '../../jobs/contract';
import type { BlobReference, ProjectDocument } from '../../project/document';
import { isObject, jsonEqual } from '../../project/document';
import type { Command } from '../../project/history';

export type Source =
  | { readonly kind: 'file'; readonly file_name: string; readonly file: BlobReference }
  | { readonly kind: 'sample'; readonly sample: string; readonly title: string };

export interface ReliefModel {
  readonly source: Source;
  /** Repaired, as `import` wrote it. */
  readonly mesh: BlobReference;
  /** For live previews; the mesh itself where that is small enough. */
  readonly preview: BlobReference;
  readonly report: Report;
}

export interface ReliefResult {
  readonly id: string;
  readonly made_unix_s: number;
  readonly backend: string;
  /** From the button to the result. */
  readonly seconds: number;
  /** Hash of the mesh it was made from. */
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

export interface ReliefDocument {
  readonly model: ReliefModel | null;
  /** Only what differs from the defaults. */
  readonly parameters: JsonObject;
  /** Newest first. */
  readonly results: readonly ReliefResult[];
  readonly pending: PendingSolve | null;
}

const empty: ReliefDocument = { model: null, parameters: {}, results: [], pending: null };
const keptResults = 12;

export function reliefOf(document: ProjectDocument): ReliefDocument {
  const stored = document.crafts['relief'];
  return isObject(stored) ? { ...empty, ...(stored as unknown as Partial<ReliefDocument>) } : empty;
}

type ReliefCommand = Omit<Command<ProjectDocument>, 'apply'> & {
  readonly change: (relief: ReliefDocument) => ReliefDocument;
};

function command({ change, ...rest }: ReliefCommand): Command<ProjectDocument> {
  const apply = (document: ProjectDocument): ProjectDocument => ({
    ...document,
    crafts: { ...document.crafts, relief: change(reliefOf(document)) as unknown as Json },
  });
  return { ...rest, apply };
}

/** A new model starts with its own viewpoint; sizes stay as the maker set them. */
export function openModel(operation: Operation, model: ReliefModel, label: string, viewpoint: JsonObject) {
  const isViewpoint = (name: string) => operation.parameters.properties[name]?.['x-group'] === 'Viewpoint';
  return command({
    label,
    change: (relief) => {
      const kept = Object.fromEntries(
        Object.entries(relief.parameters).filter(([name]) => !isViewpoint(name)),
      );
      return { ...relief, model, parameters: withoutDefaults(operation, { ...kept, ...viewpoint }) };
    },
  });
}

export function setParameters(operation: Operation, values: JsonObject, label: string, coalesce?: string) {
  return command({
    label,
    ...(coalesce ? { coalesce } : {}),
    change: (relief) => ({
      ...relief,
      parameters: withoutDefaults(operation, { ...relief.parameters, ...values }),
    }),
  });
}

export const restoreResult = (result: ReliefResult, label: string) =>
  command({ label, change: (relief) => ({ ...relief, parameters: result.parameters }) });

export const addResult = (result: ReliefResult) =>
  command({
    label: 'Solve',
    recorded: false,
    change: (relief) => ({
      ...relief,
      pending: null,
      results: [result, ...relief.results.filter((old) => !sameRequest(old, result))].slice(0, keptResults),
    }),
  });

/** More about a result that is there already: another format, its picture. */
export const amendResult = (id: string, change: (result: ReliefResult) => ReliefResult) =>
  command({
    label: 'Solve',
    recorded: false,
    change: (relief) => ({
      ...relief,
      results: relief.results.map((result) => (result.id === id ? change(result) : result)),
    }),
  });

export const removeResult = (id: string) =>
  command({
    label: 'Delete a result',
    change: (relief) => ({ ...relief, results: relief.results.filter((result) => result.id !== id) }),
  });

export const nameProject = (name: string): Command<ProjectDocument> => ({
  label: 'Name the project',
  recorded: false,
  apply: (document) => ({ ...document, name }),
});

export const setPending = (pending: PendingSolve | null) =>
  command({ label: 'Solve', recorded: false, change: (relief) => ({ ...relief, pending }) });

export function withoutDefaults(operation: Operation, values: JsonObject): JsonObject {
  const schema = operation.parameters.properties;
  return Object.fromEntries(
    Object.entries(values).filter(([name, value]) => !jsonEqual(value, schema[name]?.default ?? null)),
  );
}

/** The value in force: as set, or the operation's default. */
export const inForce = (operation: Operation, parameters: JsonObject, name: string): Json =>
  parameters[name] ?? operation.parameters.properties[name]?.default ?? null;

const sameRequest = (a: ReliefResult, b: Pick<ReliefResult, 'mesh' | 'parameters'>) =>
  a.mesh === b.mesh && jsonEqual(a.parameters, b.parameters);

/** The result made with exactly the parameters and the model in force, if there is one. */
export function currentResult(relief: ReliefDocument): ReliefResult | null {
  if (relief.model === null) return null;
  const request = { mesh: relief.model.mesh.blob, parameters: relief.parameters };
  return relief.results.find((result) => sameRequest(result, request)) ?? null;
}

/** Names a solve: equal keys, equal results. */
export const requestKey = (mesh: string, parameters: JsonObject): Json => ({ mesh, parameters });

export const meshInput = (mesh: BlobReference, name: string): JobInput => ({
  sha256: mesh.blob,
  file_name: name,
});

export const titleOf = (source: Source): string => (source.kind === 'file' ? source.file_name : source.title);
