// SPDX-License-Identifier: GPL-3.0-or-later
// A project made of built-in samples, written as the fragment of an address, which no browser sends to a server:
//   #/open?v=1&name=Bust&relief=bust&relief.thickness_mm=5
// names a room's sample, and of its parameters those that differ from the defaults. What is read is checked against the catalog.
import type { Catalog, Json, JsonObject, Operation, ParameterSchema, Sample } from '../../jobs/contract';
import { findOperation } from '../../jobs/contract';
import { withoutDefaults } from '../../shared/session/craft_document';
import { relief } from '../../crafts/relief/relief_document';
import { thermoform, offered as offeredByThermoform } from '../../crafts/thermoform/thermoform_document';
import { zippable, offered as offeredByZippable } from '../../crafts/zippable/zippable_document';
import { crafts } from '../crafts';

export const modelRooms = [relief, thermoform, zippable].map(({ craft }) => craft as ModelRoomName);
export type ModelRoomName = 'relief' | 'thermoform' | 'zippable';

export interface LinkedRoom {
  readonly room: ModelRoomName;
  readonly sample: string;
  /** Only what differs from the catalog's defaults. */
  readonly parameters: JsonObject;
}

export interface LinkedProject {
  readonly name: string;
  /** It opens in the first. */
  readonly rooms: readonly LinkedRoom[];
}

const version = '1';
/** Chats and mail programs keep addresses of this length whole. */
export const maxLinkLength = 4000;
const maxNameLength = 80;
const maxTextLength = 300;
const prefix = '#/open?';

/** All that a room offers to set, with the catalog's defaults. */
export function operationOf(catalog: Catalog, room: ModelRoomName): Operation | null {
  if (room === 'relief') return findOperation(catalog, 'relief') ?? null;
  return room === 'thermoform' ? offeredByThermoform(catalog) : offeredByZippable(catalog);
}

const titleOfRoom = (room: ModelRoomName): string =>
  crafts.find(({ place }) => place === room)?.title ?? room;

/** What marks an address as a link to a sample; it may be damaged all the same. */
export const isSampleLink = (hash: string): boolean => /^#\/open(?![a-z])/.test(hash);

// ---- writing ----

function written(value: Json): string {
  if (value === null) return 'auto';
  return Array.isArray(value) ? value.join(',') : String(value);
}

/** Chats end an address at these signs. */
const escaped = (text: string): string =>
  encodeURIComponent(text).replaceAll(
    /[!'()*~.]/g,
    (sign) => `%${sign.charCodeAt(0).toString(16).toUpperCase()}`,
  );

/** The fragment; Error with a sentence where it would be longer than what is kept whole. */
export function writeSampleLink({ name, rooms }: LinkedProject): string {
  const pairs: [string, string][] = [
    ['v', version],
    ['name', escaped(name)],
  ];
  for (const { room, sample, parameters } of rooms) {
    pairs.push([room, escaped(sample)]);
    for (const [parameter, value] of Object.entries(parameters))
      pairs.push([
        `${room}.${parameter}`,
        typeof value === 'string' ? escaped(value) : encodeURI(written(value)).replaceAll('+', '%2B'),
      ]);
  }
  const link = prefix + pairs.map((pair) => pair.join('=')).join('&');
  if (link.length > maxLinkLength)
    throw new Error(
      `So many settings differ from the defaults that the link has ${link.length} characters; chats and mail programs cut at ${maxLinkLength}. Save the project as a file instead.`,
    );
  return link;
}

// ---- reading ----

/** What a stranger wrote, short enough to be shown. */
const quoted = (text: string): string => `“${cleaned(text, 40)}${text.length > 40 ? '…' : ''}”`;
/** Without line breaks and signs that change the direction of writing. */
const cleaned = (text: string, length: number): string =>
  text
    .replaceAll(/[\p{Cc}\p{Cf}\p{Zl}\p{Zp}]/gu, ' ')
    .slice(0, length)
    .trim();

const numberIn = (text: string): number | null => {
  const value = /^-?\d{1,30}(\.\d{1,30})?(e[+-]?\d{1,3})?$/i.test(text) ? Number(text) : NaN;
  return Number.isFinite(value) ? value : null;
};

/** The value in words, or what it has to be. */
function valueIn(text: string, schema: ParameterSchema): { value: Json } | { needed: string } {
  const types = [schema.type].flat();
  if (types.includes('null') && text === 'auto') return { value: null };
  if (schema.enum)
    return schema.enum.includes(text) ? { value: text } : { needed: `one of ${schema.enum.join(', ')}` };
  if (types.includes('boolean'))
    return /^(true|false)$/.test(text) ? { value: text === 'true' } : { needed: 'true or false' };
  if (types.includes('array')) {
    const length = Array.isArray(schema.default) ? schema.default.length : 3;
    const numbers = text.split(',').map(numberIn);
    const whole = numbers.length === length && numbers.every((number) => number !== null);
    return whole ? { value: numbers } : { needed: `${length} numbers with commas in between` };
  }
  if (types.includes('string'))
    return text.length <= maxTextLength && /^[\x20-\x7e]*$/.test(text)
      ? { value: text }
      : { needed: `plain text of at most ${maxTextLength} characters` };
  const number = numberIn(text);
  const [low, high] = [schema.minimum ?? -Infinity, schema.maximum ?? Infinity];
  const whole = types.includes('integer');
  if (number === null || number < low || number > high || (whole && !Number.isInteger(number)))
    return { needed: `a ${whole ? 'whole ' : ''}number from ${low} to ${high}` };
  return { value: number };
}

/** Every name once; a second one could contradict the first. */
function pairsIn(hash: string): ReadonlyMap<string, string> {
  const pairs = new Map<string, string>();
  for (const [name, value] of new URLSearchParams(hash.slice(prefix.length))) {
    if (pairs.has(name)) throw new Error(`This link is damaged: it holds ${quoted(name)} twice.`);
    pairs.set(name, value);
  }
  return pairs;
}

function sampleIn(name: string, { samples }: Catalog): Sample {
  const sample = samples.find((one) => one.name === name);
  if (sample === undefined)
    throw new Error(`This link asks for the sample ${quoted(name)}, which this version does not have.`);
  return sample;
}

/** Checks all of it against the catalog. Throws Error with one sentence. */
export function readSampleLink(hash: string, catalog: Catalog): LinkedProject {
  if (hash.length > maxLinkLength)
    throw new Error(
      `This link has ${hash.length} characters, and links to samples have at most ${maxLinkLength}. It was not opened.`,
    );
  if (!hash.startsWith(prefix)) throw new Error('This link is damaged: nothing follows “#/open”.');
  const pairs = pairsIn(hash);
  const made = pairs.get('v');
  if (made !== version)
    throw new Error(
      /^\d+$/.test(made ?? '')
        ? 'This link was made by a newer Formwright; update the page to open it.'
        : 'This link is damaged: it does not say which version it has.',
    );
  const found = new Map<ModelRoomName, { sample: Sample; operation: Operation; values: [string, Json][] }>();
  for (const [name, value] of pairs) {
    const room = modelRooms.find((one) => one === name);
    if (room === undefined) continue;
    const operation = operationOf(catalog, room);
    if (operation === null)
      throw new Error(`This link is for the room ${titleOfRoom(room)}, which this version does not have.`);
    found.set(room, { sample: sampleIn(value, catalog), operation, values: [] });
  }
  for (const [name, value] of pairs) {
    if (name === 'v' || name === 'name' || found.has(name as ModelRoomName)) continue;
    const [, room = '', parameter = ''] = /^([a-z]+)\.(.+)$/.exec(name) ?? [];
    const inRoom = found.get(room as ModelRoomName);
    const schemas = inRoom?.operation.parameters.properties ?? {};
    const schema = Object.hasOwn(schemas, parameter) ? schemas[parameter] : undefined;
    if (inRoom === undefined || schema === undefined)
      throw new Error(`This link sets ${quoted(name)}, which this version does not have.`);
    const read = valueIn(value, schema);
    if ('needed' in read)
      throw new Error(
        `This link sets “${schema.title ?? parameter}” of ${titleOfRoom(room as ModelRoomName)} to ${quoted(value)}; it takes ${read.needed}.`,
      );
    inRoom.values.push([parameter, read.value]);
  }
  const [first] = found.values();
  if (first === undefined) throw new Error('This link is damaged: it names no sample.');
  return {
    name: cleaned(pairs.get('name') ?? '', maxNameLength) || first.sample.title,
    rooms: [...found].map(([room, { sample, operation, values }]) => ({
      room,
      sample: sample.name,
      parameters: withoutDefaults(operation, Object.fromEntries(values)),
    })),
  };
}
