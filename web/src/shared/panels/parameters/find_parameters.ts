// SPDX-License-Identifier: GPL-3.0-or-later
// Which of an operation's parameters a person means by some words, and which of them differ from the defaults.
import type { Json, JsonObject, ParameterSchema, PresetList } from '../../../jobs/contract';
import { jsonEqual } from '../../../project/document';

export type Entry = readonly [name: string, schema: ParameterSchema];

/** Of a folded group; the others are named by the catalog. */
export const groupOf = ([, schema]: Entry): string => schema['x-group'] ?? '';

/** The panel has a control for all but free text, which rooms ask for in ways of their own. */
export const hasControl = ([, schema]: Entry): boolean =>
  schema.enum !== undefined || !(schema.type === 'string');

/** Lower case, without what separates words in names (`yield_strain`) and flags (`--yield-strain`). */
const plain = (text: string): string =>
  text
    .toLowerCase()
    .replaceAll(/[\s_–-]+/g, ' ')
    .trim();

export const wordsOf = (query: string): readonly string[] => plain(query).split(' ').filter(Boolean);

/** 0: its title, name or one of its choices has the words; 1: its group or unit as well; 2: its help as well; null: not at all. */
function rankOf(entry: Entry, words: readonly string[]): number | null {
  const [name, schema] = entry;
  const choices = schema['x-choice-labels'] ?? schema.enum ?? [];
  let known = '';
  for (const [rank, texts] of [
    [schema.title ?? '', name, ...choices],
    [groupOf(entry), schema['x-unit'] ?? ''],
    [schema.description ?? ''],
  ].entries()) {
    known += ` ${texts.map(plain).join(' ')}`;
    if (words.every((word) => known.includes(word))) return rank;
  }
  return null;
}

/** Those that have all words; those that have them in their title or name come first. All of them where there are no words. */
export function findParameters(entries: readonly Entry[], query: string): readonly Entry[] {
  const words = wordsOf(query);
  if (words.length === 0) return entries;
  return entries
    .map((entry) => ({ entry, rank: rankOf(entry, words) }))
    .filter((found): found is { entry: Entry; rank: number } => found.rank !== null)
    .sort((a, b) => a.rank - b.rank)
    .map(({ entry }) => entry);
}

/** Lists of presets that have all words, in the names of their presets, too; none where there are no words. */
export function findPresets(lists: readonly PresetList[], query: string): readonly PresetList[] {
  const words = wordsOf(query);
  if (words.length === 0) return [];
  return lists.filter(({ name, title, help, presets }) => {
    const known = plain([name, title, help, ...presets.map((preset) => preset.title)].join(' '));
    return words.every((word) => known.includes(word));
  });
}

/** By group, in the order in which the groups come first. */
export function byGroup(entries: readonly Entry[]): ReadonlyMap<string, readonly Entry[]> {
  const groups = new Map<string, Entry[]>();
  for (const entry of entries) groups.set(groupOf(entry), [...(groups.get(groupOf(entry)) ?? []), entry]);
  return groups;
}

export const defaultOf = ([, schema]: Entry): Json => schema.default ?? null;

/** Whether a parameter counts with the other values: some belong to one choice only. */
export function counts([, schema]: Entry, parameters: JsonObject, all: readonly Entry[]): boolean {
  const choice = schema['x-only-with'];
  if (choice === undefined) return true;
  const declared = all.find(([name]) => name === choice.parameter);
  const value = parameters[choice.parameter] ?? (declared ? defaultOf(declared) : null);
  return typeof value === 'string' && choice.values.includes(value);
}

export const isChanged = (parameters: JsonObject, entry: Entry): boolean => {
  const value = parameters[entry[0]];
  return value !== undefined && !jsonEqual(value, defaultOf(entry));
};
