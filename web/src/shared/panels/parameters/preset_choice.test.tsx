// @vitest-environment happy-dom
// SPDX-License-Identifier: GPL-3.0-or-later
import { render } from 'preact';
import { act } from 'preact/test-utils';
import { beforeEach, expect, it, vi } from 'vitest';
import type { JsonObject, Operation } from '../../../jobs/contract';
import { PresetChoice } from './preset_choice';

const list = {
  name: 'former',
  title: 'Vacuum former',
  help: 'Sets the sheet and the vacuum.',
  group: 'Machine',
  presets: [
    { name: 'pump', title: 'With a pump', parameters: { sheet_x_mm: 240, vacuum_kpa: 80 }, hint: '' },
    {
      name: 'cleaner',
      title: 'With a cleaner',
      parameters: { sheet_x_mm: 210, vacuum_kpa: 20 },
      hint: 'Soft.',
    },
  ],
};
const operation: Operation = {
  name: 'thermoform-simulate',
  title: 'Thermoform',
  inputs: [],
  outputs: [],
  presets: [list],
  parameters: {
    properties: {
      sheet_x_mm: { type: 'number', default: 240 },
      vacuum_kpa: { type: 'number', default: 80 },
    },
  },
};
const onChoose = vi.fn();
const show = (parameters: JsonObject) => {
  render(<PresetChoice {...{ list, operation, parameters, onChoose }} />, document.body);
  return document.querySelector('select') as HTMLSelectElement;
};
const options = () => [...document.querySelectorAll('option')].map(({ textContent }) => textContent);

beforeEach(() => onChoose.mockClear());

it('the preset whose values are all in force is named, defaults included', () => {
  expect(show({}).value).toBe('pump');
  expect(options()).toEqual(['With a pump', 'With a cleaner']);
  expect(show({ sheet_x_mm: 210, vacuum_kpa: 20 }).value).toBe('cleaner');
  expect(document.querySelector('.hint')?.textContent).toBe('Soft.');
});

it('one value of its own, and none is named', () => {
  expect(show({ vacuum_kpa: 20 }).value).toBe('');
  expect(options()[0]).toBe('Own values');
  expect(document.querySelector('.hint')).toBeNull();
});

it('choosing one hands on all its values, with a name for the step', () => {
  const select = show({ vacuum_kpa: 20 });
  select.value = 'cleaner';
  void act(() => void select.dispatchEvent(new Event('change')));
  expect(onChoose.mock.calls).toEqual([[{ sheet_x_mm: 210, vacuum_kpa: 20 }, 'Use With a cleaner']]);
  select.value = '';
  void act(() => void select.dispatchEvent(new Event('change')));
  expect(onChoose).toHaveBeenCalledTimes(1);
});
