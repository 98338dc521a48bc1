// SPDX-License-Identifier: GPL-3.0-or-later
// A project: one immutable JSON value and the blobs it names. What a craft keeps in it is the craft's own
// business; here it is JSON.
import type { Json, JsonObject } from '../jobs/contract';

const documentFormat = 'formwright-project';
const documentVersion = 1;

export interface ProjectDocument {
  readonly format: typeof documentFormat;
  readonly version: number;
  readonly id: string;
  readonly name: string;
  readonly created_unix_s: number;
  /** By craft name. */
  readonly crafts: JsonObject;
}

/** How a document names a blob; any object with a `blob` member of 64 hex digits is one. */
export interface BlobReference extends JsonObject {
  readonly blob: string;
  readonly bytes: number;
  readonly media_type: string;
}

export function newDocument(id: string, name: string, now_unix_s: number): ProjectDocument {
  return {
    format: documentFormat,
    version: documentVersion,
    id,
    name,
    created_unix_s: now_unix_s,
    crafts: {},
  };
}

export const isObject = (value: unknown): value is JsonObject =>
  typeof value === 'object' && value !== null && !Array.isArray(value);

/** The hashes of all blobs a document (or a part of one) names. */
export function blobsOf(value: unknown, found = new Set<string>()): Set<string> {
  if (Array.isArray(value)) for (const item of value) blobsOf(item, found);
  else if (isObject(value)) {
    if (typeof value['blob'] === 'string' && /^[0-9a-f]{64}$/.test(value['blob'])) found.add(value['blob']);
    for (const item of Object.values(value)) blobsOf(item, found);
  }
  return found;
}

/** Checks what comes from a file or from storage. Throws Error with one sentence. */
export function asDocument(value: unknown): ProjectDocument {
  if (!isObject(value) || value['format'] !== documentFormat)
    throw new Error('This is not a Formwright project.');
  const version = value['version'];
  if (typeof version !== 'number' || version > documentVersion)
    throw new Error('This project was made by a newer Formwright; update the page to open it.');
  if (typeof value['id'] !== 'string' || typeof value['name'] !== 'string' || !isObject(value['crafts']))
    throw new Error('This project file is damaged: its document is incomplete.');
  return value as unknown as ProjectDocument;
}

export const jsonEqual = (a: Json | undefined, b: Json | undefined): boolean => {
  if (a === b) return true;
  if (Array.isArray(a) && Array.isArray(b))
    return a.length === b.length && a.every((item, i) => jsonEqual(item as Json, b[i] as Json));
  if (isObject(a) && isObject(b)) {
    const keys = Object.keys(a);
    return (
      keys.length === Object.keys(b).length &&
      keys.every((key) => Object.hasOwn(b, key) && jsonEqual(a[key], b[key]))
    );
  }
  return false;
};
