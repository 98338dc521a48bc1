// SPDX-License-Identifier: GPL-3.0-or-later
// The job contract as types: docs/job_contract.md. No default and no range of any operation is written
// in TypeScript; they come from the catalog.

export type Json = null | boolean | number | string | readonly Json[] | JsonObject;
export interface JsonObject {
  readonly [key: string]: Json;
}

export type JobInput =
  | { readonly sha256: string; readonly file_name: string }
  | { readonly sample: string; readonly vertices?: number };

export interface Job {
  readonly operation: string;
  readonly parameters: JsonObject;
  readonly inputs: Readonly<Record<string, JobInput>>;
  /** Limits what is encoded; absent: everything made by default. */
  readonly outputs?: readonly string[];
}

export type Report = JsonObject;

/** Where simulations of a job run, and how many; `name` is empty for the computer of the worker. */
export interface WorkPlace {
  readonly name: string;
  readonly running: number;
  readonly done: number;
}

export interface Progress {
  readonly fraction: number;
  readonly stage: string;
  readonly seconds_left: number | null;
  /** Only from the worker. */
  readonly places?: readonly WorkPlace[];
}

/** The contract's codes, and `unreachable`: the backend itself is gone, or does not know this page. */
export type ErrorCode =
  'invalid_input' | 'could_not_solve' | 'cancelled' | 'out_of_memory' | 'internal' | 'unreachable';

export interface ErrorMessage {
  readonly code: ErrorCode;
  /** The parameter, input or output concerned, or empty. */
  readonly where: string;
  readonly message: string;
}

export class JobError extends Error {
  readonly code: ErrorCode;
  readonly where: string;
  constructor(error: ErrorMessage) {
    super(error.message);
    this.name = 'JobError';
    this.code = error.code;
    this.where = error.where;
  }
}

export const cancelled = () => new JobError({ code: 'cancelled', where: '', message: 'Cancelled.' });

/** Any thrown value as a JobError. */
export function asJobError(thrown: unknown): JobError {
  if (thrown instanceof JobError) return thrown;
  const message = thrown instanceof Error ? thrown.message : String(thrown);
  return new JobError({ code: 'internal', where: '', message });
}

export interface OutputDescription {
  readonly media_type: string;
  readonly bytes: number;
  readonly sha256?: string;
}

/** What `_fw_run` and the worker answer. */
export type ResultMessage =
  | { readonly report: Report; readonly outputs: Readonly<Record<string, OutputDescription>> }
  | { readonly error: ErrorMessage };

// ---- catalog ----

export interface ParameterSchema {
  readonly type: string | readonly string[];
  readonly title?: string;
  readonly description?: string;
  readonly default?: Json;
  readonly minimum?: number;
  readonly maximum?: number;
  readonly enum?: readonly string[];
  readonly 'x-slider'?: readonly [number, number];
  readonly 'x-unit'?: string;
  readonly 'x-group'?: string;
  readonly 'x-advanced'?: boolean;
  /** It counts only while this choice has one of these values. */
  readonly 'x-only-with'?: { readonly parameter: string; readonly values: readonly string[] };
  readonly 'x-choice-labels'?: readonly string[];
}

export interface InputDeclaration {
  readonly name: string;
  readonly label: string;
  readonly required?: boolean;
  readonly extensions?: readonly string[];
  readonly accepts_sample?: boolean;
  /** A zip archive of these files. */
  readonly folder_files?: readonly string[];
  /** More of them as name_2, name_3, ... */
  readonly repeatable?: boolean;
  readonly help?: string;
}

export interface OutputDeclaration {
  readonly name: string;
  readonly media_type: string;
  readonly label: string;
  readonly help?: string;
  readonly default?: boolean;
}

export interface ReportField {
  readonly name: string;
  readonly label: string;
  readonly unit?: string;
  readonly help?: string;
}

/** Values of an operation's parameters, to begin with. */
interface Preset {
  readonly name: string;
  readonly title: string;
  readonly parameters: JsonObject;
  readonly hint: string;
}

/** Presets that all set the same parameters. */
export interface PresetList {
  readonly name: string;
  readonly title: string;
  readonly help: string;
  /** Of the parameters beside which it stands. */
  readonly group: string;
  readonly presets: readonly Preset[];
}

export interface Operation {
  readonly name: string;
  readonly title: string;
  readonly summary?: string;
  /** The WebAssembly module that runs it. */
  readonly module?: string;
  readonly inputs: readonly InputDeclaration[];
  readonly parameters: { readonly properties: Readonly<Record<string, ParameterSchema>> };
  readonly presets?: readonly PresetList[];
  readonly outputs: readonly OutputDeclaration[];
  readonly report?: readonly ReportField[];
}

export interface Sample {
  readonly name: string;
  readonly title: string;
  readonly description?: string;
  readonly default_vertices: number;
  readonly closed?: boolean;
  readonly has_texture?: boolean;
  /** The side it is best seen from, in the words of the relief's parameters. */
  readonly view_direction?: readonly number[];
  readonly view_up?: readonly number[];
}

interface MeshFormat {
  readonly extension: string;
  readonly media_type: string;
  readonly title: string;
}

/** Values to begin with, by the names of the laser job's parameters. */
interface LaserMaterial {
  readonly name: string;
  readonly title: string;
  readonly laser: string;
  readonly thickness_mm: number;
  readonly parameters: JsonObject;
  readonly hint: string;
}
interface LaserMaterials {
  readonly note: string;
  readonly lasers: readonly { readonly name: string; readonly title: string }[];
  readonly materials: readonly LaserMaterial[];
}

export interface Catalog {
  readonly version: string;
  readonly operations: readonly Operation[];
  readonly samples: readonly Sample[];
  readonly mesh_formats: readonly MeshFormat[];
  readonly laser_materials?: LaserMaterials;
}

export const findOperation = (catalog: Catalog, name: string): Operation | undefined =>
  catalog.operations.find((operation) => operation.name === name);
