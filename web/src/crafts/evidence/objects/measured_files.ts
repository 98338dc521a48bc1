// SPDX-License-Identifier: GPL-3.0-or-later
// What was dropped or chosen, sorted: measured objects as three files, a folder or an archive of it; scans.
import type { Zippable } from 'fflate';
import { zipSync } from 'fflate';
import { ZipReader } from '../../../project/zip_reader';
import type { ObjectFile } from '../evidence_document';
import { objectFiles } from '../evidence_document';

export type Bytes = Uint8Array<ArrayBuffer>;

export interface Found {
  readonly name: string;
  readonly files: Readonly<Partial<Record<ObjectFile, Bytes>>>;
}

export interface Sorted {
  readonly objects: readonly Found[];
  /** A scan, its materials and picture, its pattern. */
  readonly scan: readonly File[];
  /** Names of what is neither. */
  readonly strange: readonly string[];
}

const baseName = (path: string): string => path.slice(path.lastIndexOf('/') + 1);
const endsIn = (name: string, endings: readonly string[]) =>
  endings.some((ending) => name.toLowerCase().endsWith(ending));
const pictureEndings = ['.png', '.jpg', '.jpeg', '.mtl'];
const scanEndings = ['.glb', '.ply'];

/** The folder a file was dropped or chosen with, or nothing. */
const folderOf = ({ webkitRelativePath }: File): string =>
  webkitRelativePath.includes('/') ? webkitRelativePath.slice(0, webkitRelativePath.lastIndexOf('/')) : '';

/** Which of an object's files this is: by its whole name, else by its ending. */
export function roleOf(name: string): ObjectFile | null {
  const lower = name.toLowerCase();
  return (
    objectFiles.find((file) => lower === file) ??
    objectFiles.find((file) => lower.endsWith(file.slice(file.lastIndexOf('.')))) ??
    null
  );
}

/** Archives hold one object in each of their folders; notes that archivers add are passed over. */
export function objectsInArchive(bytes: Bytes, fileName: string): Found[] {
  const wanted = new Set<string>(objectFiles);
  const archive = new ZipReader(bytes, fileName);
  const folders = new Map<string, Partial<Record<ObjectFile, Bytes>>>();
  for (const [path, entry] of archive.entries) {
    const folder = path.slice(0, path.lastIndexOf('/') + 1);
    if (!wanted.has(baseName(path).toLowerCase()) || folder.startsWith('__MACOSX')) continue;
    const files = folders.get(folder) ?? {};
    files[baseName(path).toLowerCase() as ObjectFile] = archive.readNow(entry);
    folders.set(folder, files);
  }
  const stem = fileName.replace(/\.zip$/i, '');
  if (folders.size === 0) return [{ name: stem, files: {} }];
  return [...folders].map(([folder, files]) => ({
    name: folders.size === 1 ? stem : baseName(folder.replace(/\/$/, '')) || stem,
    files,
  }));
}

export async function sortFiles(files: readonly File[]): Promise<Sorted> {
  const objects: Found[] = [];
  const scan: File[] = [];
  const strange: string[] = [];
  const groups = new Map<string, File[]>();
  for (const file of files) {
    if (endsIn(file.name, ['.zip'])) {
      const bytes = new Uint8Array(await file.arrayBuffer());
      objects.push(...objectsInArchive(bytes, file.name));
    } else groups.set(folderOf(file), [...(groups.get(folderOf(file)) ?? []), file]);
  }
  for (const [folder, members] of groups) {
    const hasPicture = members.some(({ name }) => endsIn(name, pictureEndings));
    // Beside a whole object pictures are its maker's, not a scan's.
    const whole = objectFiles.every((file) => members.some(({ name }) => name.toLowerCase() === file));
    const ofScan = ({ name }: File) =>
      !whole &&
      (endsIn(name, [...scanEndings, ...pictureEndings]) ||
        name.toLowerCase() === 'pattern.json' ||
        (hasPicture && endsIn(name, ['.obj']) && name.toLowerCase() !== 'mould.obj'));
    scan.push(...members.filter(ofScan));
    const found: Partial<Record<ObjectFile, Bytes>> = {};
    const names: string[] = [];
    for (const file of members.filter((member) => !ofScan(member))) {
      const role = roleOf(file.name);
      if (role === null) {
        // Whatever else lies in an object's folder is not meant.
        if (folder === '') strange.push(file.name);
        continue;
      }
      if (found[role] && file.name.toLowerCase() !== role) continue;
      found[role] = new Uint8Array(await file.arrayBuffer());
      names.push(file.name);
    }
    if (names.length > 0) objects.push({ name: baseName(folder) || nameFrom(names), files: found });
  }
  return { objects, scan, strange };
}

/** Of an object whose files do not say more. */
export const plainName = 'Object 1';

/** What the files call themselves where that is more than their roles. */
function nameFrom(names: readonly string[]): string {
  const telling = names.find((name) => !(objectFiles as readonly string[]).includes(name.toLowerCase()));
  return telling?.replace(/\.[^.]+$/, '') ?? plainName;
}

/** "measured.csv and setup.json". */
export function missingFrom(files: Readonly<Partial<Record<ObjectFile, unknown>>>): string {
  return objectFiles.filter((name) => files[name] === undefined).join(' and ');
}

/** The same files give the same bytes: results are found again by their hash. */
export function packObject(files: Readonly<Record<ObjectFile, Bytes>>): Bytes {
  const zippable: Zippable = {};
  for (const name of objectFiles) zippable[name] = [files[name], { mtime: new Date(1980, 0, 1) }];
  return zipSync(zippable) as Bytes;
}

/** How many rows of measured.csv have a place, and how many a thickness. */
export function countReadings(csv: Bytes): { readonly points: number; readonly thickness: number } {
  const [header = '', ...rows] = new TextDecoder()
    .decode(csv)
    .split(/\r?\n/)
    .filter((line) => line.trim() !== '');
  const columns = header
    .replace('\ufeff', '')
    .split(',')
    .map((name) => name.trim());
  const filled = (name: string): number => {
    const at = columns.indexOf(name);
    return at < 0 ? 0 : rows.filter((row) => (row.split(',')[at] ?? '').trim() !== '').length;
  };
  return { points: filled('x_mm'), thickness: filled('thickness_mm') };
}
