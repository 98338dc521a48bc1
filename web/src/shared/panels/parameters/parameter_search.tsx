// SPDX-License-Identifier: GPL-3.0-or-later
// Finds a parameter by words, or lists those that differ from their defaults, each with its reset.
import type { Ref } from 'preact';
import { useEffect, useRef, useState } from 'preact/hooks';
import type { Json, PresetList } from '../../../jobs/contract';
import { formatOnStep, hideTip, Icon, IconButton } from '../../../ui';
import type { Entry } from './find_parameters';
import { byGroup, defaultOf, findParameters, findPresets, isChanged, wordsOf } from './find_parameters';
import type { ParameterValues } from './parameter_control';
import { ParameterControl } from './parameter_control';
import './parameter_search.css';

export interface Search {
  readonly query: string;
  readonly setQuery: (query: string) => void;
  readonly onlyChanged: boolean;
  readonly setOnlyChanged: (only: boolean) => void;
  /** How many values differ from their defaults. */
  readonly changed: number;
  /** What is listed in the place of the groups; null while nothing is asked for. */
  readonly found: readonly Entry[] | null;
  /** Lists of presets beside them. */
  readonly foundPresets: readonly PresetList[];
  /** What was found, in a sentence; empty while nothing is asked for. */
  readonly sentence: string;
  readonly field: Ref<HTMLInputElement>;
}

const settings = (count: number) => (count === 1 ? '1 setting' : `${count} settings`);

function sentenceOf(query: string, onlyChanged: boolean, found: number, of: number): string {
  const words = query.trim();
  if (wordsOf(query).length === 0)
    return found === 0
      ? 'All settings have their default values.'
      : `${settings(found)} of ${of} changed from the default.`;
  if (found > 0) return `${settings(found)} found.`;
  return onlyChanged
    ? `No changed setting has “${words}” in its name, group, unit or help.`
    : `No setting has “${words}” in its name, group, unit or help. Try one shorter word.`;
}

export function useParameterSearch(
  entries: readonly Entry[],
  presets: readonly PresetList[],
  values: ParameterValues,
): Search {
  const field = useRef<HTMLInputElement>(null);
  const [query, setQuery] = useState('');
  // What was listed stays while it is set, also where it passes its default.
  const [listed, setListed] = useState<ReadonlySet<string> | null>(null);
  useFindKey(field);
  const changed = entries.filter((entry) => isChanged(values.parameters, entry));
  const names = new Set(changed.map(([name]) => name));
  const asked = wordsOf(query).length > 0;
  const onlyChanged = listed !== null;
  const among = onlyChanged ? entries.filter(([name]) => names.has(name) || listed.has(name)) : entries;
  const hits = findParameters(among, query);
  // A value that the solver refuses is shown in any case.
  const refused = entries.filter((entry) => values.errors[entry[0]] !== undefined && !hits.includes(entry));
  const foundPresets = onlyChanged ? [] : findPresets(presets, query);
  const count = asked ? hits.length + foundPresets.length : changed.length;
  return {
    query,
    setQuery,
    onlyChanged,
    setOnlyChanged: (only) => setListed(only ? names : null),
    changed: changed.length,
    found: asked || onlyChanged ? [...refused, ...hits] : null,
    foundPresets,
    sentence: asked || onlyChanged ? sentenceOf(query, onlyChanged, count, entries.length) : '',
    field,
  };
}

/** P goes to the field, as the list of keys says. */
function useFindKey(field: { readonly current: HTMLInputElement | null }): void {
  useEffect(() => {
    const onKey = (event: KeyboardEvent) => {
      if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.key.toLowerCase() !== 'p' || field.current === null) return;
      if ((event.target as Element).matches('input[type=text], select, textarea')) return;
      const dialogs = [...document.querySelectorAll('dialog[open]')];
      if (dialogs.some((dialog) => !dialog.contains(field.current))) return;
      event.preventDefault();
      field.current.focus();
      field.current.select();
    };
    document.addEventListener('keydown', onKey);
    return () => document.removeEventListener('keydown', onKey);
  }, []);
}

export function ParameterSearch({ search }: { readonly search: Search }) {
  const { query, onlyChanged, changed, sentence } = search;
  const keys = (event: KeyboardEvent & { readonly currentTarget: HTMLElement }) => {
    if (event.key === 'Escape' && query !== '') {
      event.preventDefault();
      event.stopPropagation();
      search.setQuery('');
    } else if (event.key === 'Enter' && !event.ctrlKey && !event.metaKey) {
      event.preventDefault();
      const next = event.currentTarget.closest('.find-setting')?.nextElementSibling;
      next?.querySelector<HTMLElement>('input, select, button')?.focus();
    }
  };
  return (
    <div class="find-setting" role="search" aria-label="Settings">
      <div class="find-line">
        <div class="number find-field">
          <Icon name="search" small />
          <input
            ref={search.field}
            type="text"
            role="searchbox"
            aria-label="Find a setting"
            aria-keyshortcuts="P"
            placeholder="Find a setting"
            autocomplete="off"
            spellcheck={false}
            enterkeyhint="search"
            value={query}
            onInput={(event) => {
              hideTip(); // what it belongs to may go away
              search.setQuery(event.currentTarget.value);
            }}
            onKeyDown={keys}
          />
          {query === '' ? null : (
            <IconButton icon="close" label="Clear the search" onClick={() => search.setQuery('')} />
          )}
        </div>
        <button
          type="button"
          class="changed-filter"
          aria-pressed={onlyChanged}
          aria-label={`Only changed settings, ${changed}`}
          onClick={() => search.setOnlyChanged(!onlyChanged)}
        >
          Changed <span>{changed}</span>
        </button>
      </div>
      <p class="found-count" role="status">
        {sentence}
      </p>
    </div>
  );
}

/** In words, as the control shows it. */
function defaultWords(entry: Entry): string {
  const [, schema] = entry;
  const value: Json = defaultOf(entry);
  if (typeof value === 'boolean') return value ? 'on' : 'off';
  if (Array.isArray(value)) return value.map((number) => formatOnStep(Number(number), 1)).join(', ');
  const choice = schema.enum?.indexOf(String(value)) ?? -1;
  return schema['x-choice-labels']?.[choice] ?? String(value);
}

interface FoundProps {
  readonly found: readonly Entry[];
  readonly values: ParameterValues;
}

/** In full under the names of their groups, whether these are folded or not. */
export function FoundParameters({ found, values }: FoundProps) {
  return (
    <>
      {[...byGroup(found)].map(([title, members]) => (
        <section key={title} class="section" aria-label={title || 'Parameters'}>
          {title ? <h3>{title}</h3> : null}
          {members.map((entry) => (
            <div key={entry[0]} class="found-setting">
              <ParameterControl entry={entry} {...values} />
              <Reset entry={entry} values={values} />
            </div>
          ))}
        </section>
      ))}
    </>
  );
}

/** Numbers have a reset beside their label. */
function Reset({ entry, values }: { readonly entry: Entry; readonly values: ParameterValues }) {
  const [name, schema] = entry;
  const types = [schema.type].flat();
  const isNumber = schema.enum === undefined && (types.includes('number') || types.includes('integer'));
  if (isNumber || !isChanged(values.parameters, entry)) return null;
  const words = defaultWords(entry);
  return (
    <button
      type="button"
      class="was"
      aria-label={`Restore ${schema.title ?? name} to ${words}`}
      onClick={(event) => {
        // This button goes away with the difference; the keyboard goes on from the control.
        const control = event.currentTarget.parentElement?.querySelector<HTMLElement>(
          '[tabindex="0"], input, select, .switch',
        );
        if (event.detail === 0) control?.focus();
        values.onPreview(name, defaultOf(entry));
        values.onCommit();
      }}
    >
      default {words}
    </button>
  );
}
