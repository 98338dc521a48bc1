// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { Catalog } from '../jobs/contract';
import { roomFor } from './choose_craft';

const catalog = { mesh_formats: [{ extension: 'obj' }, { extension: 'glb' }] } as unknown as Catalog;
const files = (...names: string[]) => names.map((name) => new File([], name));

describe('where files go', () => {
  it('asks what becomes of a model on the start page, and in no room', () => {
    expect(roomFor(files('cat.png', 'cat.OBJ'), 'start', catalog)).toBeNull();
    expect(roomFor(files('cat.obj'), 'zippable', catalog)).toBe('zippable');
    expect(roomFor(files('cat.obj'), 'evidence', catalog)).toBe('evidence');
  });
  it('takes drawings and jobs to the machines from everywhere', () => {
    for (const here of ['start', 'relief', 'thermoform', 'zippable'] as const)
      for (const name of ['plate.svg', 'job.nc', 'JOB.GCODE'])
        expect(roomFor(files(name), here, catalog)).toBe('machines');
  });
  it('takes a height map on the start page to the mill, and leaves a picture to the room', () => {
    expect(roomFor(files('height.png'), 'start', catalog)).toBe('machines');
    expect(roomFor(files('texture.png'), 'thermoform', catalog)).toBe('thermoform');
  });
  it('takes measured objects to evidence', () => {
    expect(roomFor(files('mould.obj', 'setup.json', 'measured.csv'), 'start', catalog)).toBe('evidence');
    expect(roomFor(files('object.zip'), 'relief', catalog)).toBe('evidence');
  });
  it('lets a room say of a strange file what it reads', () => {
    expect(roomFor(files('notes.txt'), 'start', catalog)).toBe('relief');
    expect(roomFor(files('notes.txt'), 'machines', catalog)).toBe('machines');
  });
});
