// SPDX-License-Identifier: GPL-3.0-or-later
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { expect, it } from 'vitest';
import type { Catalog } from '../../../jobs/contract';
import { findOperation } from '../../../jobs/contract';
import type { Entry } from './find_parameters';
import { byGroup, counts, findParameters, hasControl, isChanged } from './find_parameters';

const catalog = JSON.parse(
  readFileSync(resolve(import.meta.dirname, '../../../../../tests/job/catalog.json'), 'utf8'),
) as Catalog;
const entriesOf = (operation: string): Entry[] =>
  Object.entries(findOperation(catalog, operation)?.parameters.properties ?? {});
const entries = entriesOf('thermoform-mould');
const names = (query: string) => findParameters(entries, query).map(([name]) => name);

it('finds a parameter by its title, its own name and the name of its flag', () => {
  const entry = entries.find(([name]) => name === 'yield_strain');
  expect(entry).toBeDefined();
  for (const query of [entry?.[1].title ?? '', 'yield_strain', 'YIELD strain', '--yield-strain'])
    expect(names(query)[0]).toBe('yield_strain');
});

it('finds by group, unit, choice and words of the help text', () => {
  for (const [name, schema] of entries) {
    expect(names(schema['x-group'] ?? '')).toContain(name);
    if (schema['x-unit']) expect(names(schema['x-unit'])).toContain(name);
    for (const label of schema['x-choice-labels'] ?? []) expect(names(label)).toContain(name);
    expect(names((schema.description ?? '').split(/[ .,:]/, 4).join(' '))).toContain(name);
  }
});

it('puts what is called so before what only mentions it, and needs every word', () => {
  const found = findParameters(entries, 'thickness');
  const titled = found.map(([name, { title = '' }]) => /thickness/i.test(title + name));
  expect(titled.includes(true) && titled.includes(false)).toBe(true);
  expect(titled).toEqual([...titled].sort((a, b) => Number(b) - Number(a)));
  expect(names('thickness zebra')).toEqual([]);
  expect(names(' - ')).toHaveLength(entries.length);
});

it('keeps all of a group together', () => {
  const groups = byGroup(findParameters(entries, 'mm'));
  const sum = [...groups.values()].reduce((count, members) => count + members.length, 0);
  expect(sum).toBe(names('mm').length);
  for (const [title, members] of groups)
    for (const [, schema] of members) expect(schema['x-group'] ?? '').toBe(title);
});

it('knows which values differ, and what has no control', () => {
  const up = entries.find(([name]) => name === 'up') as Entry;
  expect(isChanged({}, up)).toBe(false);
  expect(isChanged({ up: [0, 1, 0] }, up)).toBe(false);
  expect(isChanged({ up: [0, 0, 1] }, up)).toBe(true);
  const optional = entriesOf('zippable-design').find(([, { type }]) => Array.isArray(type)) as Entry;
  expect(isChanged({ [optional[0]]: null }, optional)).toBe(false);
  const withoutControl = entriesOf('laser-job').filter((entry) => !hasControl(entry));
  expect(withoutControl.map(([name]) => name)).toEqual(['no_go']);
});

it('knows which parameters count with the choice that is made', () => {
  const all = entriesOf('relief');
  const named = (name: string) => all.find(([own]) => own === name) ?? expect.fail(name);
  const pitch = named('base_pitch_mm');
  expect(counts(pitch, {}, all)).toBe(false);
  expect(counts(pitch, { base: 'groove' }, all)).toBe(true);
  expect(counts(pitch, { base: 'cylinder' }, all)).toBe(false);
  expect(counts(named('thickness_mm'), { base: 'groove' }, all)).toBe(true);
  expect(counts(named('field_of_view_deg'), {}, all)).toBe(true);
  expect(counts(named('field_of_view_deg'), { projection: 'orthographic' }, all)).toBe(false);
});
