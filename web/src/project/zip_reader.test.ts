// SPDX-License-Identifier: GPL-3.0-or-later
import { zipSync } from 'fflate';
import { describe, expect, it } from 'vitest';
import { unpackProject } from './archive';
import { BlobStore } from './blob_store';
import { newDocument } from './document';
import { parseJson } from './json_text';
import { MemoryStorage } from './storage';
import { ZipReader } from './zip_reader';

const patient = { timeout: 60_000 }; // packs tens of megabytes

type Bytes = Uint8Array<ArrayBuffer>;
const text = (value: string) => new TextEncoder().encode(value);
const words = (bytes: Uint8Array) => new TextDecoder().decode(bytes);
const archive = (files: Record<string, Uint8Array>): Bytes => zipSync(files) as Bytes;
const two = () => archive({ 'a.txt': text('words '.repeat(500)), 'b.txt': text('b') });

/** Where the directory's record of the nth entry begins. */
function record(bytes: Bytes, n: number): number {
  const view = new DataView(bytes.buffer);
  let at = view.getUint32(bytes.length - 6, true);
  for (let i = 0; i < n; ++i)
    at += 46 + view.getUint16(at + 28, true) + view.getUint16(at + 30, true) + view.getUint16(at + 32, true);
  return at;
}
function altered(bytes: Bytes, place: number, value: number): Bytes {
  const copy = bytes.slice();
  new DataView(copy.buffer).setUint32(place, value, true);
  return copy;
}
function readAll(bytes: Bytes): string[] {
  const reader = new ZipReader(bytes, 'The file');
  return [...reader.entries.values()].map((entry) => words(reader.readNow(entry)));
}

describe('an archive from elsewhere', () => {
  it('is read as it was packed', patient, async () => {
    expect(readAll(two())).toEqual(['words '.repeat(500), 'b']);
    expect(readAll(archive({}))).toEqual([]);
    const stored = zipSync({ 'a.txt': text('as it is') }, { level: 0 }) as Bytes;
    expect(readAll(stored)).toEqual(['as it is']);
    const noise = Uint8Array.from({ length: 300_000 }, (_, i) => (i * 2654435761) >>> 13);
    const reader = new ZipReader(archive({ noise }), 'The file');
    const [entry] = reader.entries.values();
    expect(entry && (await reader.read(entry))).toEqual(noise);
  });

  it('is refused where it is cut short, at every length', () => {
    const whole = two();
    for (let length = 0; length < whole.length; ++length)
      expect(() => readAll(whole.slice(0, length)), `${length}`).toThrow(/damaged|more than 4 GB/);
  });

  it('is refused where a checksum does not match', () => {
    const whole = two();
    expect(() => readAll(altered(whole, record(whole, 1) + 16, 12345))).toThrow(/damaged/);
  });

  it('is refused where the directory lies about sizes, either way', () => {
    const whole = two();
    for (const bytes of [0, 1, 2999, 3001, 1_000_000, 0xfffffffe])
      expect(() => readAll(altered(whole, record(whole, 0) + 24, bytes)), `${bytes}`).toThrow(
        /damaged|far more/,
      );
    for (const packed of [0, 3, 0xfffffff0])
      expect(() => readAll(altered(whole, record(whole, 0) + 20, packed)), `${packed}`).toThrow(/damaged/);
  });

  it('is refused where entries share their bytes, or lie outside', () => {
    const whole = two();
    const first = new DataView(whole.buffer).getUint32(record(whole, 0) + 42, true);
    for (const offset of [first, first + 1, whole.length, 0xfffffffe])
      expect(() => readAll(altered(whole, record(whole, 1) + 42, offset)), `${offset}`).toThrow(/damaged/);
  });

  it('is refused where a name stands twice', () => {
    const whole = archive({ a: text('1'), b: text('2') });
    whole[record(whole, 1) + 46] = 'a'.charCodeAt(0);
    expect(() => readAll(whole)).toThrow(/damaged/);
  });

  it('is refused where it claims to need 64 bits', () => {
    const whole = two();
    expect(() => readAll(altered(whole, whole.length - 6, 0xffffffff))).toThrow(/more than 4 GB/);
    expect(() => readAll(altered(whole, whole.length - 12, 0xffffffff))).toThrow(/more than 4 GB/);
    expect(() => readAll(altered(whole, record(whole, 0) + 24, 0xffffffff))).toThrow(/damaged|far more/);
  });

  it('is refused where it is encrypted or packed otherwise', () => {
    const whole = two();
    const view = new DataView(whole.buffer);
    view.setUint16(record(whole, 0) + 10, 14, true);
    expect(() => readAll(whole)).toThrow(/unusual way/);
    view.setUint16(record(whole, 0) + 10, 8, true);
    view.setUint16(record(whole, 0) + 8, 1, true);
    expect(() => readAll(whole)).toThrow(/encrypted/);
  });

  it('unpacks no more than a file of its size holds, all entries together', patient, () => {
    const part = new Uint8Array(20 * 2 ** 20);
    const bomb = archive({ a: part, b: part, c: part, d: part });
    expect(bomb.length).toBeLessThan(100_000);
    const reader = new ZipReader(bomb, 'The file');
    const entries = [...reader.entries.values()];
    for (const entry of entries.slice(0, 3)) expect(reader.readNow(entry)).toHaveLength(part.length);
    expect(() => reader.readNow(entries[3] as (typeof entries)[0])).toThrow(
      /far more than a file of its size/,
    );
  });
});

describe('a project file from elsewhere', () => {
  const store = () => new BlobStore(new MemoryStorage());
  const unpacked = (files: Record<string, Uint8Array>) => unpackProject(archive(files), store());

  it('does not unpack what its document does not name', patient, async () => {
    const document = newDocument('one', 'One', 1);
    const files = { 'project.json': text(JSON.stringify(document)), bomb: new Uint8Array(80 * 2 ** 20) };
    expect(await unpacked(files)).toEqual(document);
  });

  it('does not unpack a bomb that it names', patient, async () => {
    const sha256 = 'a'.repeat(64);
    const document = { ...newDocument('one', 'One', 1), crafts: { relief: { blob: sha256 } } };
    const files = {
      'project.json': text(JSON.stringify(document)),
      [`blobs/${sha256}`]: new Uint8Array(90 * 2 ** 20),
    };
    await expect(unpacked(files)).rejects.toThrow(/unpacks to far more than a file of its size holds/);
  });

  it('has a document of a size that a project has, and not nested without end', patient, async () => {
    const blanks = new Uint8Array(17 * 2 ** 20).fill(32);
    await expect(unpacked({ 'project.json': blanks })).rejects.toThrow(/larger than any project/);
    const deep = `{"format":"formwright-project","crafts":${'['.repeat(200_000)}`;
    await expect(unpacked({ 'project.json': text(deep) })).rejects.toThrow(/cannot be read/);
  });
});

describe('JSON from elsewhere', () => {
  it('nests 64 deep and no deeper; brackets in words do not count', () => {
    const nested = (depth: number) => '['.repeat(depth) + ']'.repeat(depth);
    expect(parseJson(nested(64))).toBeInstanceOf(Array);
    expect(() => parseJson(nested(65))).toThrow();
    expect(parseJson(`["${'['.repeat(100)}\\"[["]`)).toHaveLength(1);
    expect(parseJson(`[${'[],'.repeat(1000)}1]`)).toHaveLength(1001);
    expect(() => parseJson('{')).toThrow();
  });
});
