// SPDX-License-Identifier: GPL-3.0-or-later
// A change as the list of places where two documents differ. It can be applied and taken back on a
// document that has meanwhile changed elsewhere: a result that arrives is not undone with a slider.
import type { Json, JsonObject } from '../jobs/contract';
import { isObject, jsonEqual } from './document';

export interface Change {
  readonly path: readonly string[];
  /** `undefined`: the place did not exist. */
  readonly before: Json | undefined;
  readonly after: Json | undefined;
}

/** Arrays count as one value. */
export function difference(before: Json, after: Json, path: readonly string[] = []): Change[] {
  if (before === after) return [];
  if (!isObject(before) || !isObject(after)) return jsonEqual(before, after) ? [] : [{ path, before, after }];
  const keys = new Set([...Object.keys(before), ...Object.keys(after)]);
  return [...keys].flatMap((key): Change[] => {
    const [a, b] = [own(before, key), own(after, key)];
    if (a === undefined || b === undefined)
      return a === b ? [] : [{ path: [...path, key], before: a, after: b }];
    return difference(a, b, [...path, key]);
  });
}

const own = (object: JsonObject, key: string): Json | undefined =>
  Object.hasOwn(object, key) ? object[key] : undefined;

function setAt(
  value: Json | undefined,
  path: readonly string[],
  replacement: Json | undefined,
): Json | undefined {
  const [key, ...rest] = path;
  if (key === undefined) return replacement;
  const object = isObject(value) ? value : {};
  const inner = setAt(own(object, key), rest, replacement);
  if (inner === undefined) {
    return Object.fromEntries(Object.entries(object).filter(([name]) => name !== key));
  }
  return { ...object, [key]: inner };
}

export const redoChanges = <T extends Json>(document: T, changes: readonly Change[]): T =>
  changes.reduce<Json>((value, { path, after }) => setAt(value, path, after) ?? null, document) as T;

export const undoChanges = <T extends Json>(document: T, changes: readonly Change[]): T =>
  changes.reduceRight<Json>((value, { path, before }) => setAt(value, path, before) ?? null, document) as T;

/** Two changes one after the other as one. */
export function joinChanges(first: readonly Change[], second: readonly Change[]): Change[] {
  const joined = new Map(first.map((change) => [JSON.stringify(change.path), change]));
  for (const change of second) {
    const key = JSON.stringify(change.path);
    const earlier = joined.get(key);
    joined.set(key, earlier ? { ...change, before: earlier.before } : change);
  }
  return [...joined.values()].filter(({ before, after }) => !jsonEqual(before, after));
}
