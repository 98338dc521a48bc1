// SPDX-License-Identifier: GPL-3.0-or-later
import { strToU8, unzipSync, zipSync } from 'fflate';
import { describe, expect, it } from 'vitest';
import type { Bytes } from './measured_files';
import {
  countReadings,
  missingFrom,
  objectsInArchive,
  packObject,
  roleOf,
  sortFiles,
} from './measured_files';

const bytes = (text: string) => strToU8(text) as Bytes;
const file = (name: string, folder?: string): File => {
  const made = new File([name], name);
  Object.defineProperty(made, 'webkitRelativePath', { value: folder ? `${folder}/${name}` : '' });
  return made;
};
const three = ['mould.obj', 'setup.json', 'measured.csv'];
const names = (files: object) => Object.keys(files).sort();

describe('what is dropped on the evidence room', () => {
  it('is an object when its three files come together', async () => {
    const { objects, scan, strange } = await sortFiles(three.map((name) => file(name)));
    expect(objects.map(({ name }) => name)).toEqual(['Object 1']);
    expect(missingFrom(objects[0]?.files ?? {})).toBe('');
    expect([scan, strange]).toEqual([[], []]);
  });

  it('is an object a folder, whatever else lies there', async () => {
    const files = ['lamp', 'box'].flatMap((folder) =>
      [...three, 'notes.txt'].map((name) => file(name, `all/${folder}`)),
    );
    const { objects, strange } = await sortFiles(files);
    expect(objects.map(({ name }) => name)).toEqual(['lamp', 'box']);
    expect(objects.every(({ files: own }) => missingFrom(own) === '')).toBe(true);
    expect(strange).toEqual([]);
  });

  it('says what is missing, and what is strange', async () => {
    const { objects, strange } = await sortFiles([file('lamp.csv'), file('picture.tiff')]);
    expect(objects[0]?.name).toBe('lamp');
    expect(missingFrom(objects[0]?.files ?? {})).toBe('mould.obj and setup.json');
    expect(strange).toEqual(['picture.tiff']);
  });

  it('is a scan where a picture or a pattern is there', async () => {
    const { objects, scan } = await sortFiles([file('scan.obj'), file('scan.png'), file('pattern.json')]);
    expect(objects).toEqual([]);
    expect(scan.map(({ name }) => name)).toEqual(['scan.obj', 'scan.png', 'pattern.json']);
  });

  it('knows files by their whole name first', () => {
    expect(roleOf('MEASURED.CSV')).toBe('measured.csv');
    expect(roleOf('lamp.obj')).toBe('mould.obj');
    expect(roleOf('lamp.stl')).toBeNull();
  });

  it('reads archives of one object or of several', () => {
    const object = Object.fromEntries(three.map((name) => [name, bytes(name)]));
    const one = zipSync(object) as Bytes;
    expect(objectsInArchive(one, 'lamp.zip').map(({ name, files }) => [name, names(files)])).toEqual([
      ['lamp', [...three].sort()],
    ]);
    const two = zipSync({
      all: { lamp: object, box: object },
      __MACOSX: { 'mould.obj': bytes('x') },
    }) as Bytes;
    expect(objectsInArchive(two, 'all.zip').map(({ name }) => name)).toEqual(['lamp', 'box']);
    expect(missingFrom(objectsInArchive(zipSync({ a: bytes('x') }) as Bytes, 'a.zip')[0]?.files ?? {})).toBe(
      'mould.obj and setup.json and measured.csv',
    );
  });

  it('packs the same files into the same bytes', () => {
    const files = {
      'mould.obj': bytes('v'),
      'setup.json': bytes('{}'),
      'measured.csv': bytes('x_mm\n1\n2\n'),
    };
    const pack = packObject(files);
    expect(pack).toEqual(packObject({ ...files }));
    expect(names(unzipSync(pack))).toEqual([...three].sort());
    expect(countReadings(files['measured.csv'])).toEqual({ points: 2, thickness: 0 });
    const mixed = bytes(
      '\ufeffsheet_x_mm,sheet_y_mm,x_mm,thickness_mm\r\n0,0,1,\n0,0,1,0.9\n9,0,,1.1\n9,0,,\n',
    );
    expect(countReadings(mixed)).toEqual({ points: 2, thickness: 2 });
  });
});
