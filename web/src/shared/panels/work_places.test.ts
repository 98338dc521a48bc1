// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import { placesText } from './work_places';

it('says how many simulations run where', () => {
  expect(
    placesText([
      { name: '', running: 2, done: 1031 },
      { name: 'lab-b', running: 1, done: 0 },
    ]),
  ).toBe('Simulations: this computer 2 running, 1,031 done; lab-b 1 running');
});

it('says nothing while there are none', () => {
  expect(placesText()).toBeUndefined();
  expect(placesText([{ name: '', running: 0, done: 0 }])).toBeUndefined();
});
