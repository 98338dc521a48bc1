// SPDX-License-Identifier: GPL-3.0-or-later
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { expect, it } from 'vitest';
import type { Catalog } from '../../../jobs/contract';
import { findOperation } from '../../../jobs/contract';
import { newDocument } from '../../../project/document';
import { relief } from '../relief_document';
import {
  clock,
  dayOf,
  daySentence,
  lightControls,
  lightOperation,
  lightParameters,
  setLight,
  srgbOf,
} from './light_values';

const file = resolve(import.meta.dirname, '../../../../../tests/job/catalog.json');
const catalog = JSON.parse(readFileSync(file, 'utf8')) as Catalog;
const operation = findOperation(catalog, lightOperation);
if (operation === undefined) throw new Error('the catalog has no relief-light');

const controls = (light: string) => Object.keys(lightControls(operation, { light }).parameters.properties);

it('offers what belongs to the kind of light, and nothing of the relief', () => {
  expect(controls('sun')).toContain('hour');
  expect(controls('sun')).not.toContain('window_width_mm');
  expect(controls('window')).toEqual(
    expect.arrayContaining(['light', 'light_distance_mm', 'window_width_mm']),
  );
  expect(controls('window')).not.toContain('latitude_deg');
  for (const kind of ['sun', 'sun_angles', 'overcast', 'bright_sky', 'window', 'strobe'])
    expect(controls(kind)).not.toContain('thickness_mm');
});

it('keeps the light in the project, without what is the default', () => {
  const start = newDocument('', '', 0);
  const set = setLight(operation, { hour: 9, light: 'overcast' }).apply(start);
  expect(relief.of(set).light).toEqual({ hour: 9, light: 'overcast' });
  expect(relief.of(setLight(operation, { light: 'sun' }).apply(set)).light).toEqual({ hour: 9 });
  expect(relief.of(start).light).toEqual({});
});

it('asks for less detail while one looks for a light', () => {
  const made = { thickness_mm: 3, unknown: 1 };
  const preview = { report: { size_mm: [120, 180, 8] } };
  const asked = lightParameters(operation, made, { hour: 8 }, preview);
  expect(asked).toMatchObject({ thickness_mm: 3, hour: 8, light_samples: 48 });
  expect(asked).not.toHaveProperty('unknown');
  expect(asked['light_pixel_mm']).toBeCloseTo(180 / 220, 2);
  expect(asked['pixel_mm']).toBeCloseTo(90 / 220, 2);
  expect(lightParameters(operation, made, { hour: 8 }, null)).toEqual({ thickness_mm: 3, hour: 8 });
  // A coarser solid stays as it is.
  expect(lightParameters(operation, { pixel_mm: 2 }, {}, preview)['pixel_mm']).toBe(2);
});

it('shows light as a screen does', () => {
  const shown = srgbOf(new Float32Array([0, 0.0031308, 0.2140411, 1]));
  [0, 0.04045, 0.5, 1].forEach((value, i) => expect(shown[i]).toBeCloseTo(value, 5));
});

const row = (hour: number, similarity: number | null, sun_on_wall = false) => ({
  hour,
  similarity,
  sun_on_wall,
});

it('reads the hours of the day', () => {
  const day = dayOf({
    day: [row(0, null), row(8, 0.6), row(8.5, 0.4, true), row(9, 0.5, true), 'no row'],
    best_hour: 8,
    best_sun_hour: 9,
  });
  expect(day?.hours).toHaveLength(4);
  expect(day?.hours[2]).toEqual({ hour: 8.5, similarity: 0.4, sunOnWall: true });
  expect(day && daySentence(day)).toBe(
    'Daylight from 8:00 to 9:00. The relief looks most like the model at 8:00. In the sun it is best at 9:00.',
  );
  expect(dayOf({})).toBeNull();
});

it('says so where the sun does not come', () => {
  const north = dayOf({ day: [row(8, 0.6)], best_hour: 8, best_sun_hour: null });
  expect(north && daySentence(north)).toContain('The sun does not shine on this wall on this day.');
  const polar = dayOf({ day: [row(8, null)], best_hour: null, best_sun_hour: null });
  expect(polar && daySentence(polar)).toBe('There is no daylight on this day.');
});

it('writes hours as a clock does', () => {
  expect([0, 9, 13.5, 23.999].map(clock)).toEqual(['0:00', '9:00', '13:30', '24:00']);
});
