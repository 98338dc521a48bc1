// SPDX-License-Identifier: GPL-3.0-or-later
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { expect, it } from 'vitest';
import type { Catalog, Json, JsonObject } from '../../jobs/contract';
import { newDocument } from '../../project/document';
import { listed, linkTo } from './project_link';
import { readSampleLink } from './sample_link';

const file = resolve(import.meta.dirname, '../../../../tests/job/catalog.json');
const catalog = JSON.parse(readFileSync(file, 'utf8')) as Catalog;
const mesh = { blob: 'a'.repeat(64), bytes: 1, media_type: 'application/x-ply' };
const modelFrom = (source: JsonObject): JsonObject => ({ source, mesh, preview: mesh, report: {} });
const sample = modelFrom({ kind: 'sample', sample: 'bust', title: 'Bust' });
const projectWith = (crafts: JsonObject) => ({ ...newDocument('id', 'Vase', 0), crafts });
const linkOf = (crafts: JsonObject, here = 'relief') => linkTo(projectWith(crafts), catalog, here);
const opened = (crafts: JsonObject, here?: string) => {
  const made = linkOf(crafts, here);
  return 'link' in made ? { ...readSampleLink(made.link, catalog), leftOut: made.leftOut } : made;
};

it('holds the samples and settings of all rooms, and opens in the one that was looked at', () => {
  const crafts = {
    relief: { model: sample, parameters: { thickness_mm: 7 }, results: [{ id: 'r' }] },
    thermoform: { model: sample, parameters: { yield_strain: 0.15 } },
  };
  expect(opened(crafts, 'thermoform')).toEqual({
    name: 'Vase',
    rooms: [
      { room: 'thermoform', sample: 'bust', parameters: { yield_strain: 0.15 } },
      { room: 'relief', sample: 'bust', parameters: { thickness_mm: 7 } },
    ],
    leftOut: [],
  });
});

it('there is none for a model of one’s own, even beside a sample, nor without a sample', () => {
  const own = modelFrom({ kind: 'file', file_name: 'ball.obj', file: mesh });
  expect(linkOf({ relief: { model: sample }, zippable: { model: own } })).toMatchObject({
    reason: 'for samples only',
    sentence: expect.stringContaining('ball.obj is a file of your own') as string,
  });
  expect(linkOf({ evidence: { objects: [] } })).toMatchObject({ reason: 'no sample in it' });
});

it('names what it leaves out', () => {
  const drawn = { on: mesh.blob, openings: [[0, 0, 1]], borders: [], cuts: [], begun: [], begunCut: [] };
  const crafts: Record<string, Json> = {
    zippable: { model: sample, drawn: { ...drawn, segments: null } },
    machines: { drawing: { file_name: 'plate.svg', kind: 'drawing', file: mesh } },
  };
  expect(opened(crafts)).toMatchObject({ leftOut: ['the drawn parts', 'the machine’s job'] });
  expect(listed(['a', 'b', 'c'])).toBe('a, b and c');
  expect(listed(['a'])).toBe('a');
});

it('takes the values in force from a machine profile, and says that it has not the profile itself', () => {
  const profile = { name: 'Former', from: 'x', file: mesh, parameters: { yield_strain: 0.2 } };
  const crafts = { thermoform: { model: sample, parameters: {} }, machine: { profile } };
  expect(opened(crafts)).toMatchObject({
    rooms: [{ room: 'thermoform', parameters: { yield_strain: 0.2 } }],
    leftOut: ['the machine profile'],
  });
});

it('where too much was changed it says so', () => {
  const parameters = { part_windings: '%'.repeat(2000) };
  expect(linkOf({ zippable: { model: sample, parameters } })).toMatchObject({ reason: 'too many settings' });
});
