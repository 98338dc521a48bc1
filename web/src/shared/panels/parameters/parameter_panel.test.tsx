// @vitest-environment happy-dom
// SPDX-License-Identifier: GPL-3.0-or-later
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { signal } from '@preact/signals';
import { render } from 'preact';
import { beforeEach, expect, it } from 'vitest';
import type { Catalog, Json, JsonObject } from '../../../jobs/contract';
import { findOperation } from '../../../jobs/contract';
import { ParameterPanel } from './parameter_panel';

const file = resolve(import.meta.dirname, '../../../../../tests/job/catalog.json');
const catalog = JSON.parse(readFileSync(file, 'utf8')) as Catalog;
const settle = () => new Promise((done) => setTimeout(done, 20));
const parameters = signal<JsonObject>({});
const one = <E extends HTMLElement>(selector: string) => document.querySelector<E>(selector);
const headings = () => [...document.querySelectorAll('h3')].map(({ textContent }) => textContent);
const status = () => one('[role=status]')?.textContent;
const button = (name: RegExp) =>
  [...document.querySelectorAll('button')].find((found) =>
    name.test(found.getAttribute('aria-label') ?? found.textContent ?? ''),
  );
const press = async (target: EventTarget | null, key: string) => {
  target?.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true }));
  await settle();
};
const type = async (words: string) => {
  const field = one<HTMLInputElement>('[role=searchbox]');
  if (field) field.value = words;
  field?.dispatchEvent(new Event('input', { bubbles: true }));
  await settle();
};

function Panel({ operation: name, errors = {} }: { operation: string; errors?: Record<string, string> }) {
  const operation = findOperation(catalog, name);
  return operation ? (
    <ParameterPanel
      operation={operation}
      parameters={parameters.value}
      errors={errors}
      openGroups={['Sheet']}
      onPreview={(changed: string, value: Json) =>
        (parameters.value = { ...parameters.value, [changed]: value })
      }
      onCommit={() => undefined}
      onPreset={(values) => (parameters.value = { ...parameters.value, ...values })}
    />
  ) : null;
}
const show = async (operation: string, errors = {}) => {
  render(null, document.body);
  render(<Panel operation={operation} errors={errors} />, document.body);
  await settle();
};
beforeEach(() => (parameters.value = {}));

it('an operation with few parameters has no search', async () => {
  await show('evidence-diagnose-relief');
  expect(one('[role=searchbox]')).toBeNull();
});

it('finds what is folded, says how many, and Escape shows everything again', async () => {
  await show('thermoform-mould');
  expect(headings()).toEqual(['Sheet']);
  await press(document.body, 'p');
  expect(document.activeElement).toBe(one('[role=searchbox]'));
  await type('yield_strain');
  const found = document.querySelectorAll('.found-setting');
  expect(status()).toBe(`${found.length} settings found.`);
  expect(headings()[0]).toBe('Material');
  expect(found[0]?.querySelector('label')?.textContent).toBe('Yield strain');
  expect(found[0]?.querySelector('input[type=text]')).not.toBeNull();
  await type('xyzzy');
  expect(status()).toMatch(/^No setting has “xyzzy”/);
  await press(one('[role=searchbox]'), 'Escape');
  expect(one<HTMLInputElement>('[role=searchbox]')?.value).toBe('');
  expect(headings()).toEqual(['Sheet']);
  expect(status()).toBe('');
});

it('a folded group counts what differs; the list of changed settings resets each', async () => {
  parameters.value = { up: [0, 0, 1], yield_strain: 0.2 };
  await show('thermoform-mould');
  for (const group of ['Advanced', 'Material'])
    expect(button(new RegExp(`^${group}`))?.textContent).toMatch(new RegExp(`${group}1 of \\d+ changed`));
  button(/^Only changed settings, 2/)?.click();
  await settle();
  expect(headings().sort()).toEqual(['Material', 'Placement']);
  button(/^Restore Up to 0, 1, 0/)?.click();
  await settle();
  expect(parameters.value['up']).toEqual([0, 1, 0]);
  expect(headings()).toContain('Placement'); // it stays in the list while this is looked at
  expect(status()).toMatch(/^1 setting of \d+ changed/);
  button(/^Restore Yield strain to/)?.click();
  await settle();
  expect(status()).toBe('All settings have their default values.');
  button(/^Only changed settings, 0/)?.click();
  await settle();
  expect(headings()).toEqual(['Sheet']);
});

it('a refused value is listed whatever is searched for', async () => {
  await show('thermoform-mould', { yield_strain: 'It is too large.' });
  await type('triangles');
  expect(one('[role=alert]')?.textContent).toBe('It is too large.');
});

it('presets stand in their group and are found by the names of what they stand for', async () => {
  await show('thermoform-mould');
  const plastics = () =>
    one<HTMLSelectElement>('section[aria-label=Sheet] select, section[aria-label=Presets] select');
  expect(plastics()?.selectedOptions[0]?.textContent).toBe('PVC, rigid');
  await type('petg');
  expect(headings()).not.toContain('Sheet');
  expect(status()).toMatch(/^\d settings? found\.$/);
  const select = plastics();
  if (select) select.value = 'petg';
  select?.dispatchEvent(new Event('change', { bubbles: true }));
  await settle();
  expect(parameters.value['density_kg_per_m3']).toBe(1270);
  expect(plastics()?.selectedOptions[0]?.textContent).toBe('PETG');
});
