// SPDX-License-Identifier: GPL-3.0-or-later
import { beforeEach, describe, expect, it } from 'vitest';
import { BlobStore } from './blob_store';
import { ProjectStore } from './project_store';
import { MemoryStorage } from './storage';

const bytes = (text: string) => new TextEncoder().encode(text);
const full = () => Promise.reject(new DOMException('full', 'QuotaExceededError'));

/** Has room for so many blobs. */
class SmallStorage extends MemoryStorage {
  room = Infinity;
  documentsFit = true;
  override async writeBlob(sha256: string, content: Uint8Array<ArrayBuffer>): Promise<void> {
    if ((await this.listBlobs()).length >= this.room) return await full();
    await super.writeBlob(sha256, content);
  }
  override async writeProject(id: string, document: object): Promise<void> {
    if (!this.documentsFit) return await full();
    await super.writeProject(id, document);
  }
}

let storage: SmallStorage;
let store: ProjectStore;
beforeEach(() => {
  storage = new SmallStorage();
  store = new ProjectStore(storage, new BlobStore(storage));
});
/** As the crafts keep bytes: a full storage does not stop the work. */
async function use(text: string): Promise<string> {
  const blob = await store.blobs.put(bytes(text)).catch(() => store.blobs.hold(bytes(text)));
  store.do({
    label: 'Use',
    apply: (d) => ({ ...d, crafts: { relief: { mesh: { blob, bytes: text.length, media_type: 'x' } } } }),
  });
  return blob;
}

it('a project whose model did not fit is not called saved', async () => {
  storage.room = 0;
  await use('big');
  await store.flush();
  expect(store.saveState.value).toMatchObject({ state: 'failed', message: /no room left/ });
  expect(await storage.readProjects()).toEqual([]);
});

it('room made by deleting another project is used at once', async () => {
  const old = await use('old');
  await store.flush();
  const oldId = store.document.value.id;
  await store.create();
  storage.room = 1;
  const big = await use('big');
  await store.flush();
  expect(store.saveState.value.state).toBe('failed');
  await store.remove(oldId);
  expect(store.saveState.value.state).toBe('saved');
  expect(await storage.hasBlob(old)).toBe(false);
  const again = new ProjectStore(storage, new BlobStore(storage));
  await again.load(store.document.value.id);
  expect(again.isBlank.value).toBe(false);
  expect(await again.blobs.read(big)).toEqual(bytes('big'));
});

describe.each([
  ['the model', () => (storage.room = 1)],
  ['the document', () => (storage.documentsFit = false)],
])('where %s does not fit', (_, fill) => {
  let old: string;
  let file: Uint8Array<ArrayBuffer>;
  beforeEach(async () => {
    await use('old');
    await store.flush();
    old = store.document.value.id;
    file = await store.exportFile();
    await store.create();
    fill();
    await use('unsaved');
  });

  it.each<[string, () => Promise<void>]>([
    ['new', () => store.create()],
    ['open', () => store.open(old)],
    ['duplicate', () => store.duplicate()],
    ['a file', () => store.importFile(file)],
  ])('%s is refused and the work stays, with its undo', async (_name, leave) => {
    const { value: before } = store.document;
    await expect(leave()).rejects.toThrow(/not saved yet, so it stays open\. .*no room left/);
    expect(store.document.value).toBe(before);
    expect(store.undoLabel.value).toBe('Use');
    expect(store.saveState.value.state).toBe('failed');
  });

  it('the project itself can be deleted', async () => {
    await store.remove(store.document.value.id);
    expect(store.isBlank.value).toBe(true);
    expect(store.saveState.value.state).toBe('saved');
    await store.open(old);
    expect(store.document.value.id).toBe(old);
  });
});

it('a change while the project is saved before another is opened is saved, too', async () => {
  await use('old');
  await store.flush();
  const old = store.document.value.id;
  await store.create();
  await use('new');
  const id = store.document.value.id;
  const write = storage.writeProject.bind(storage);
  storage.writeProject = async (...given) => {
    storage.writeProject = write;
    store.rename('Named meanwhile');
    await write(...given);
  };
  await store.open(old);
  await store.open(id);
  expect(store.document.value.name).toBe('Named meanwhile');
});

it('deleting while a save is under way does not bring the project back', async () => {
  await use('mesh');
  let goOn = () => {};
  const write = storage.writeProject.bind(storage);
  storage.writeProject = async (...given) => {
    await new Promise<void>((resolve) => (goOn = resolve));
    await write(...given);
  };
  const saving = store.flush();
  await new Promise((resolve) => setTimeout(resolve));
  const removing = store.remove(store.document.value.id);
  await new Promise((resolve) => setTimeout(resolve));
  goOn();
  await Promise.all([saving, removing]);
  expect(await storage.readProjects()).toEqual([]);
  expect(store.saveState.value.state).toBe('saved');
  expect(store.projects.value).toEqual([]);
});

it('a project file that does not fit is refused in a sentence', async () => {
  await use('mesh');
  const file = await store.exportFile();
  const other = new SmallStorage();
  other.room = 0;
  const there = new ProjectStore(other, new BlobStore(other));
  await expect(there.importFile(file)).rejects.toThrow(/no room left/);
});
