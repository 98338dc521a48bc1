// SPDX-License-Identifier: GPL-3.0-or-later
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { describe, expect, it } from 'vitest';
import { takeToken, tokenIn } from '../../jobs/native_connection';
import type { Catalog, Json, ParameterSchema } from '../../jobs/contract';
import type { LinkedProject } from './sample_link';
import {
  isSampleLink,
  maxLinkLength,
  modelRooms,
  operationOf,
  readSampleLink,
  writeSampleLink,
} from './sample_link';

const file = resolve(import.meta.dirname, '../../../../tests/job/catalog.json');
const catalog = JSON.parse(readFileSync(file, 'utf8')) as Catalog;
const read = (rest: string) => readSampleLink(`#/open?v=1&name=x&${rest}`, catalog);
const throughTheAddress = (project: LinkedProject) => {
  const { hash } = new URL(writeSampleLink(project), 'https://example.org/somewhere/');
  expect(isSampleLink(hash)).toBe(true);
  expect(tokenIn(hash)).toBeNull();
  return readSampleLink(hash, catalog);
};

/** A value that is not the default, at a place between 0 and 1 of what is possible. */
function other(schema: ParameterSchema, share: number): Json {
  const types = [schema.type].flat();
  if (schema.enum) return schema.enum.find((choice) => choice !== schema.default) ?? null;
  if (types.includes('boolean')) return schema.default !== true;
  if (types.includes('array')) return [share, -share / 3, 1e-7 * share];
  if (types.includes('string')) return '3 0 2.5; a=b&c <b>"';
  const value = (schema.minimum ?? 0) + share * ((schema.maximum ?? 1) - (schema.minimum ?? 0));
  return types.includes('integer') ? Math.round(value) : value;
}

describe('round trip', () => {
  for (const room of modelRooms)
    it(`every parameter of ${room} comes back as it was, and no link is longer than what is read`, () => {
      const operation = operationOf(catalog, room);
      const properties = Object.entries(operation?.parameters.properties ?? {});
      expect(properties.length).toBeGreaterThan(10);
      for (const [i, [name, schema]] of properties.entries()) {
        const parameters = { [name]: other(schema, (i + 0.37) / properties.length) };
        const project = { name: 'Lion', rooms: [{ room, sample: 'bust', parameters }] };
        expect(throughTheAddress(project)).toEqual(project);
      }
    });

  it('several rooms, the first of which is opened, and a name in any writing', () => {
    const project: LinkedProject = {
      name: 'Löwe, 狮子 & <b>“x”</b> #1 100% a+b',
      rooms: [
        { room: 'zippable', sample: 'star', parameters: { windings: 3 } },
        { room: 'relief', sample: 'bust', parameters: { up: [0, 0, 1] } },
        { room: 'thermoform', sample: 'bust', parameters: {} },
      ],
    };
    expect(throughTheAddress(project)).toEqual(project);
  });

  it('values that are the defaults are not set', () => {
    const [name, schema] = Object.entries(operationOf(catalog, 'relief')?.parameters.properties ?? {}).find(
      ([, { type }]) => type === 'number',
    ) ?? ['', { type: '' }];
    expect(read(`relief=bust&relief.${name}=${String(schema.default)}`).rooms[0]?.parameters).toEqual({});
  });

  it('says so where it would be too long', () => {
    const parameters = { part_windings: '"'.repeat(300) };
    const rooms = modelRooms.map((room) => ({ room, sample: 'bust', parameters }));
    const many = Array.from({ length: 5 }, () => rooms).flat();
    expect(() => writeSampleLink({ name: 'x', rooms: many })).toThrow(/Save the project as a file/);
  });
});

describe('a link that somebody else wrote', () => {
  const refused: [string, string, RegExp][] = [
    ['an unknown sample', 'relief=lion', /asks for the sample “lion”/],
    ['no sample', '', /names no sample/],
    ['an unknown room', 'forge=bust', /sets “forge”/],
    ['a room that takes no sample', 'evidence=bust', /sets “evidence”/],
    ['an unknown parameter', 'relief=bust&relief.wings=2', /sets “relief.wings”/],
    ['values of a room without a model', 'relief=bust&zippable.windings=3', /sets “zippable.windings”/],
    ['words for a number', 'relief=bust&relief.thickness_mm=thick', /it takes a number from/],
    ['a number out of range', 'relief=bust&relief.thickness_mm=-5', /it takes a number from/],
    ['a huge number', 'relief=bust&relief.thickness_mm=1e999', /it takes a number from/],
    ['no number', 'relief=bust&relief.thickness_mm=NaN', /it takes a number from/],
    ['a number in another notation', 'relief=bust&relief.thickness_mm=0x5', /it takes a number from/],
    ['nothing', 'relief=bust&relief.thickness_mm=', /it takes a number from/],
    ['JSON', 'relief=bust&relief.up={"0":1}', /it takes 3 numbers/],
    ['too many numbers', `relief=bust&relief.up=${'1,'.repeat(900)}1`, /it takes 3 numbers/],
    ['the same twice', 'relief=bust&relief=cat', /holds “relief” twice/],
    ['a sample named like an object’s own', 'relief=__proto__', /sample “__proto__”/],
    ['a parameter named __proto__', 'relief=bust&relief.__proto__=1', /sets “relief.__proto__”/],
    ['a parameter named constructor', 'relief=bust&relief.constructor=1', /sets “relief.constructor”/],
    ['a room named __proto__', 'relief=bust&__proto__=1', /sets “__proto__”/],
    ['a room’s parameter named __proto__.x', 'relief=bust&__proto__.polluted=1', /sets “__proto__/],
    ['a line break', 'relief=bust%0A', /sample “bust”/],
  ];
  for (const [what, rest, sentence] of refused)
    it(`with ${what} is refused in one sentence`, () => {
      expect(() => read(rest)).toThrow(sentence);
      expect(({} as Record<string, unknown>)['polluted']).toBeUndefined();
      try {
        read(rest);
      } catch (thrown) {
        const { message } = thrown as Error;
        expect(message.length).toBeLessThan(300);
        expect(message).not.toMatch(/\n/);
      }
    });

  it('is refused where it is too long, newer or damaged', () => {
    const open = (hash: string) => () => readSampleLink(hash, catalog);
    expect(open(`#/open?v=1&relief=bust&name=${'a'.repeat(maxLinkLength)}`)).toThrow(/characters/);
    expect(open('#/open?v=2&relief=bust')).toThrow(/newer Formwright/);
    for (const damaged of ['#/open', '#/open/', '#/open?', '#/open?%%%', '#/open?eyJhIjoxfQ'])
      expect(open(damaged), damaged).toThrow(/This link is damaged/);
  });

  it('has a name of one line, of at most 80 characters', () => {
    const name = (text: string) =>
      readSampleLink(`#/open?v=1&name=${encodeURIComponent(text)}&relief=bust`, catalog).name;
    expect(name('a\u202eb\nc')).toBe('a b c');
    expect(name('x'.repeat(200))).toHaveLength(80);
    expect(name(' \n ')).toBe('Bust');
    expect(name('<img src=x onerror=alert(1)>')).toBe('<img src=x onerror=alert(1)>'); // text, and shown as such
  });

  it('is not taken for a place or a token', () => {
    for (const hash of ['', '#/relief', '#/start', '#token=a', '#/opened', '#/'])
      expect(isSampleLink(hash), hash).toBe(false);
  });

  it('comes with a worker’s token, which is taken out of it', () => {
    const link = '#/open?v=1&relief=bust&relief.up=0,0,1';
    let left = '';
    const memory = { getItem: () => null, setItem: () => undefined };
    takeToken({ hash: `${link}&token=abc`, pathname: '/', search: '' }, memory, (url) => (left = url));
    expect(left).toBe(`/${link}`);
  });
});
