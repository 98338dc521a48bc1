// SPDX-License-Identifier: GPL-3.0-or-later
import { beforeEach, describe, expect, it } from 'vitest';
import type { Catalog, Operation } from '../../jobs/contract';
import { practiceLaser, practiceMill, ProfileStore } from '../../machines/profiles';
import { emptyRoom } from '../../shared/session/craft_document';
import { laserSheet } from './laser_in_use';
import type { MachinesDocument } from './machines_document';
import { laserJob, millJob } from './machines_document';

const number = (value: number, group: string) => ({ type: 'number', default: value, 'x-group': group });
const operation = (name: string, bed_mm: number): Operation => ({
  name,
  title: name,
  inputs: [],
  outputs: [],
  parameters: {
    properties: {
      bed_x_mm: number(bed_mm, 'Machine'),
      bed_y_mm: number(bed_mm, 'Machine'),
      ...(name === laserJob ? { kerf_mm: number(0.1, 'Cutting'), cut_power_percent: number(80, 'Cut') } : {}),
    },
  },
});
const felt = {
  name: 'felt',
  title: 'Felt 3 mm',
  laser: 'co2',
  thickness_mm: 3,
  hint: '',
  parameters: { cut_power_percent: 35, kerf_mm: 0.25 },
};
const catalog: Catalog = {
  version: '',
  operations: [operation(laserJob, 410), operation(millJob, 300)],
  samples: [],
  mesh_formats: [],
  laser_materials: { note: '', lasers: [], materials: [felt] },
};
const untouched: MachinesDocument = { ...emptyRoom, drawing: null, set_aside: {}, machine: null };
const file = { blob: 'a', bytes: 1, media_type: 'x' };
const drawing = { file_name: 'star.svg', kind: 'drawing', file } as const;
const workshop = {
  ...practiceLaser,
  id: 'w',
  name: 'Workshop',
  parameters: { bed_x_mm: 600, bed_y_mm: 300 },
  materials: [{ name: 'Card', parameters: { cut_power_percent: 20, kerf_mm: 0.12 } }],
};

describe('the chosen laser', () => {
  let profiles = new ProfileStore({ getItem: () => null, setItem: () => undefined }, {});
  beforeEach(() => (profiles = new ProfileStore({ getItem: () => null, setItem: () => undefined }, {})));
  const sheet = (document = untouched) => laserSheet(profiles, document, catalog);

  it('has the bed of its profile, or the one that the operation declares', () => {
    expect(sheet()).toEqual({
      laser: 'Practice laser',
      bed_x_mm: 410,
      bed_y_mm: 410,
      material: null,
      kerf_mm: null,
    });
    profiles.put(workshop);
    expect(sheet()).toMatchObject({ laser: 'Workshop', bed_x_mm: 600, bed_y_mm: 300 });
    expect(laserSheet(profiles, untouched, null)).toBeNull();
    expect(laserSheet(profiles, untouched, { ...catalog, operations: [] })).toBeNull();
  });

  it('is no mill: while one is chosen, the laser that was used last counts', () => {
    profiles.put(workshop);
    profiles.put(practiceMill);
    expect(sheet()).toMatchObject({ laser: 'Workshop', bed_x_mm: 600, bed_y_mm: 300 });
  });

  it('has the bed that was set for it in the project', () => {
    profiles.put(workshop);
    expect(sheet({ ...untouched, drawing, parameters: { bed_x_mm: 500 } })).toMatchObject({
      bed_x_mm: 500,
      bed_y_mm: 410,
    });
    // Of another machine, which was in use when the project was worked on last, nothing counts.
    expect(sheet({ ...untouched, drawing, machine: 'other', parameters: { bed_x_mm: 500 } })).toMatchObject({
      bed_x_mm: 600,
      bed_y_mm: 300,
    });
    // A test of the material stands in the drawing's place: the laser's jobs are kept aside.
    const test = { file_name: 'Test', kind: 'test', instead_of: drawing } as const;
    const aside = { drawing: test, set_aside: { [laserJob]: { bed_x_mm: 450 } } };
    expect(sheet({ ...untouched, ...aside })).toMatchObject({ bed_x_mm: 450 });
  });

  it('has the kerf of the material whose values are in force, of its own or of those to begin with', () => {
    profiles.put(workshop);
    const used = (cut_power_percent: number, kerf_mm: number) =>
      sheet({ ...untouched, drawing, parameters: { cut_power_percent, kerf_mm } });
    expect(used(20, 0.12)).toMatchObject({ material: 'Card', kerf_mm: 0.12 });
    expect(used(35, 0.25)).toMatchObject({ material: 'Felt 3 mm', kerf_mm: 0.25 });
    expect(used(35, 0.12)).toMatchObject({ material: null, kerf_mm: null });
  });
});
