// SPDX-License-Identifier: GPL-3.0-or-later
import 'fake-indexeddb/auto';
import { zipSync } from 'fflate';
import { beforeEach, describe, expect, it } from 'vitest';
import { packProject, unpackProject } from './archive';
import { BlobStore } from './blob_store';
import { newDocument } from './document';
import { IndexedDbStorage } from './indexeddb_storage';
import { ProjectStore } from './project_store';
import type { ProjectStorage } from './storage';
import { MemoryStorage, storageSentence } from './storage';

const bytes = (text: string) => new TextEncoder().encode(text);
let databases = 0;

describe.each([
  ['memory', () => Promise.resolve<ProjectStorage>(new MemoryStorage())],
  ['IndexedDB', () => IndexedDbStorage.open(`test${databases++}`) as Promise<ProjectStorage>],
])('projects in %s', (_, open) => {
  let storage: ProjectStorage;
  let store: ProjectStore;
  beforeEach(async () => {
    storage = await open();
    store = new ProjectStore(storage, new BlobStore(storage));
  });
  const reopened = async () => {
    const again = new ProjectStore(storage, new BlobStore(storage));
    await again.load(store.document.value.id);
    return again;
  };
  const use = async (text: string) => {
    const blob = await store.blobs.put(bytes(text));
    store.do({
      label: 'Use',
      apply: (d) => ({ ...d, crafts: { relief: { mesh: { blob, bytes: text.length, media_type: 'x' } } } }),
    });
    return blob;
  };

  it('keeps nothing of a blank project', async () => {
    await store.flush();
    expect(await storage.readProjects()).toEqual([]);
  });

  it('finds the work again after a reload', async () => {
    const blob = await use('mesh');
    store.rename('Lion');
    expect(store.saveState.value.state).toBe('unsaved');
    await store.flush();
    expect(store.saveState.value.state).toBe('saved');
    const again = await reopened();
    expect(again.document.value).toEqual(store.document.value);
    expect(await again.blobs.read(blob)).toEqual(bytes('mesh'));
    expect(again.projects.value.map(({ name }) => name)).toEqual(['Lion']);
  });

  it('duplicates, switches and deletes; blobs go with their last project', async () => {
    const blob = await use('mesh');
    const first = store.document.value.id;
    await store.duplicate();
    const second = store.document.value.id;
    expect(second).not.toBe(first);
    await store.remove(first);
    expect(await storage.hasBlob(blob)).toBe(true);
    await store.remove(second);
    expect(await storage.hasBlob(blob)).toBe(false);
    expect(store.isBlank.value).toBe(true);
    expect((await reopened()).projects.value).toEqual([]);
  });

  it('goes through a file and back, beside the original', async () => {
    await use('mesh');
    await store.flush();
    const original = store.document.value;
    await store.importFile(await store.exportFile());
    expect(store.document.value.crafts).toEqual(original.crafts);
    expect(store.document.value.id).not.toBe(original.id);
    expect(store.projects.value).toHaveLength(2);
  });
});

describe('project files', () => {
  const blobs = () => new BlobStore(new MemoryStorage());
  const file = (files: Record<string, Uint8Array>) => zipSync(files) as Uint8Array<ArrayBuffer>;

  it('carry every blob the document names', async () => {
    const from = blobs();
    const blob = await from.put(bytes('abc'));
    const document = { ...newDocument('1', 'n', 0), crafts: { relief: { outputs: [{ blob }] } } };
    const to = blobs();
    expect(await unpackProject(await packProject(document, from), to)).toEqual(document);
    expect(await to.read(blob)).toEqual(bytes('abc'));
  });

  it.each([
    ['what is no zip', bytes('hello'), /not a complete zip/],
    ['a zip of something else', file({ 'a.txt': bytes('x') }), /no project.json/],
    ['a broken document', file({ 'project.json': bytes('{') }), /cannot be read/],
    ['a foreign document', file({ 'project.json': bytes('{}') }), /not a Formwright project/],
    [
      'a newer version',
      file({ 'project.json': bytes('{"format":"formwright-project","version":99}') }),
      /newer/,
    ],
  ])('are refused in a sentence: %s', async (_, content, sentence) => {
    await expect(unpackProject(content as Uint8Array<ArrayBuffer>, blobs())).rejects.toThrow(sentence);
  });

  it('with a blob that was changed are refused', async () => {
    const blob = 'a'.repeat(64);
    const document = { ...newDocument('1', 'n', 0), crafts: { relief: { blob } } };
    const content = file({
      'project.json': bytes(JSON.stringify(document)),
      [`blobs/${blob}`]: bytes('forged'),
    });
    await expect(unpackProject(content, blobs())).rejects.toThrow(/checksum/);
  });
});

it('says a full disk in words, and the bytes stay readable', async () => {
  const storage = new MemoryStorage();
  storage.writeBlob = () => Promise.reject(new DOMException('full', 'QuotaExceededError'));
  const store = new BlobStore(storage);
  const error = await store.put(bytes('x')).catch((thrown: unknown) => thrown);
  expect(storageSentence(error)).toMatch(/no room left/);
  const hash = await store.hold(bytes('x'));
  expect(await store.read(hash)).toEqual(bytes('x'));
});

it('says that a project could not be saved, and saves it when it can again', async () => {
  const storage = new MemoryStorage();
  const write = storage.writeProject.bind(storage);
  storage.writeProject = () => Promise.reject(new DOMException('full', 'QuotaExceededError'));
  const store = new ProjectStore(storage, new BlobStore(storage));
  store.do({ label: 'a', apply: (d) => ({ ...d, crafts: { relief: {} } }) });
  await store.flush();
  expect(store.saveState.value).toMatchObject({ state: 'failed' });
  storage.writeProject = write;
  await store.flush();
  expect(store.saveState.value.state).toBe('saved');
});
