// SPDX-License-Identifier: GPL-3.0-or-later
// Tabs are stores over one storage.
import { describe, expect, it } from 'vitest';
import { BlobStore } from './blob_store';
import { ProjectLocks } from './project_locks';
import { ProjectStore } from './project_store';
import { MemoryStorage } from './storage';

const bytes = (text: string) => new TextEncoder().encode(text);

/** What of the browser's lock manager is used here: exclusive locks, first come, first served. */
class Locks {
  readonly #queues = new Map<string, (() => void)[]>();
  request(name: string, { signal }: { signal: AbortSignal }, held: () => Promise<void>): Promise<void> {
    const queue = this.#queues.get(name) ?? [];
    this.#queues.set(name, queue);
    return new Promise((resolve, reject) => {
      const begin = () =>
        void held().then(() => {
          queue.shift();
          queue[0]?.();
          resolve();
        });
      queue.push(begin);
      if (queue.length === 1) begin();
      signal.addEventListener('abort', () => {
        if (queue.indexOf(begin) < 1) return; // held already
        queue.splice(queue.indexOf(begin), 1);
        reject(signal.reason as Error);
      });
    });
  }
}

class Browser {
  readonly storage = new MemoryStorage();
  readonly locks: Pick<LockManager, 'request'> | undefined;
  constructor(locks: object | undefined) {
    this.locks = locks as typeof this.locks;
  }
  async tab(id: string | null = null) {
    const locks = new ProjectLocks(this.locks, 50);
    const store = new ProjectStore(this.storage, new BlobStore(this.storage), locks);
    const warning = await store.load(id);
    return { store, warning };
  }
}

async function use(store: ProjectStore, text: string): Promise<string> {
  const blob = await store.blobs.put(bytes(text));
  store.do({
    label: 'Use',
    apply: (d) => ({ ...d, crafts: { relief: { mesh: { blob, bytes: text.length, media_type: 'x' } } } }),
  });
  return blob;
}
const idOf = (store: ProjectStore) => store.document.value.id;

describe('deleting a project', () => {
  it('leaves the models that another tab has saved since', async () => {
    const browser = new Browser(new Locks());
    const [a, b] = [(await browser.tab()).store, (await browser.tab()).store];
    const gone = await use(a, 'of a');
    await a.flush();
    const kept = await use(b, 'of b');
    await b.flush();
    await a.remove(idOf(a));
    expect(await browser.storage.hasBlob(gone)).toBe(false);
    expect(await browser.storage.hasBlob(kept)).toBe(true);
  });

  it('leaves what another tab has read and not named yet', async () => {
    const browser = new Browser(new Locks());
    const [a, b] = [(await browser.tab()).store, (await browser.tab()).store];
    await use(a, 'of a');
    await a.flush();
    const unnamed = await b.blobs.put(bytes('of b'));
    await a.remove(idOf(a));
    expect(await browser.storage.hasBlob(unnamed)).toBe(true);
  });

  it('takes a model that another tab is about to name: that tab writes it again', async () => {
    const browser = new Browser(new Locks());
    const [a, b] = [(await browser.tab()).store, (await browser.tab()).store];
    const shared = await use(a, 'both');
    await a.flush();
    await use(b, 'both');
    await a.remove(idOf(a));
    expect(await browser.storage.hasBlob(shared)).toBe(false);
    await b.flush();
    expect(b.saveState.value.state).toBe('saved');
    expect(await browser.storage.hasBlob(shared)).toBe(true);
  });

  it('takes what undo alone would have brought back, and leaves what undo of the open one still may', async () => {
    const browser = new Browser(new Locks());
    const { store } = await browser.tab();
    const first = await use(store, 'one');
    await store.flush();
    await store.duplicate();
    const second = await use(store, 'two');
    await store.flush();
    const [original] = store.projects.value.filter(({ id }) => id !== idOf(store));
    await store.remove(original?.id ?? '');
    expect(await browser.storage.hasBlob(first)).toBe(true);
    await store.remove(idOf(store));
    expect(await browser.storage.listBlobs()).not.toContain(first);
    expect(await browser.storage.listBlobs()).not.toContain(second);
  });

  it('does not touch what is open in another tab', async () => {
    const browser = new Browser(new Locks());
    const { store: a } = await browser.tab();
    await use(a, 'of a');
    await a.flush();
    const { store: b } = await browser.tab();
    await expect(b.remove(idOf(a))).rejects.toThrow(/open in another tab/);
    expect(await browser.storage.readProjects()).toHaveLength(1);
  });
});

it('a sweep leaves the blobs of newer versions, and what waits in memory to be named', async () => {
  const browser = new Browser(new Locks());
  const { store } = await browser.tab();
  const other = new BlobStore(browser.storage);
  const [newer, orphan] = [await other.put(bytes('newer')), await other.put(bytes('orphan'))];
  const waiting = await store.blobs.put(bytes('waiting'));
  const document = { format: 'formwright-project', version: 99, id: 'n', parts: [{ blob: newer }] };
  await browser.storage.writeProject('n', { document, modified_unix_s: 0 });
  await store.load(null);
  await store.sweep();
  expect((await browser.storage.listBlobs()).sort()).toEqual([newer, waiting].sort());
  expect(await browser.storage.hasBlob(orphan)).toBe(false);
});

describe('one project and two tabs', () => {
  const lion = async (browser: Browser) => {
    const { store } = await browser.tab();
    await use(store, 'lion');
    store.rename('Lion');
    await store.flush();
    return store;
  };

  it('the second begins with a new project, and says why', async () => {
    const browser = new Browser(new Locks());
    const a = await lion(browser);
    const { store: b, warning } = await browser.tab(idOf(a));
    expect(warning).toMatch(/“Lion” is open in another tab/);
    expect(b.isBlank.value).toBe(true);
    expect(idOf(b)).not.toBe(idOf(a));
  });

  it('the second cannot open it until the first has turned to another, and then finds its last state', async () => {
    const browser = new Browser(new Locks());
    const a = await lion(browser);
    const { store: b } = await browser.tab();
    await use(b, 'of b');
    const [ofA, ofB] = [idOf(a), idOf(b)];
    await expect(b.open(ofA)).rejects.toThrow(/“Lion” is open in another tab\. Continue there/);
    expect(idOf(b)).toBe(ofB);
    a.rename('Lioness');
    await a.create();
    await Promise.all([b.open(ofA), b.open(ofA)]); // a double click
    expect(b.document.value.name).toBe('Lioness');
    await expect(a.open(ofA)).rejects.toThrow(/open in another tab/);
    await a.open(ofB); // which b has let go of
    expect(a.document.value.crafts).not.toEqual({});
  });

  it('a page that is reloaded waits for itself', async () => {
    const browser = new Browser(new Locks());
    const a = await lion(browser);
    const again = browser.tab(idOf(a));
    setTimeout(() => void a.create(), 20);
    const { store, warning } = await again;
    expect(warning).toBeNull();
    expect(store.document.value.name).toBe('Lion');
  });

  it('what was deleted in one is not there in the other', async () => {
    const browser = new Browser(new Locks());
    const a = await lion(browser);
    const { store: b } = await browser.tab();
    const id = idOf(a);
    await a.remove(id);
    await expect(b.open(id)).rejects.toThrow(/deleted in another tab/);
    expect(b.projects.value).toEqual([]);
    await use(b, 'x');
    await b.flush();
    expect(b.projects.value).toHaveLength(1);
  });

  it('a file of it becomes another project in the second', async () => {
    const browser = new Browser(new Locks());
    const a = await lion(browser);
    const { store: b } = await browser.tab();
    await b.importFile(await a.exportFile());
    expect(idOf(b)).not.toBe(idOf(a));
    expect(b.projects.value).toHaveLength(2);
  });

  it('a browser without locks opens it twice, one that refuses them too', async () => {
    const refusing = { request: () => Promise.reject(new DOMException('no', 'SecurityError')) };
    for (const locks of [undefined, refusing]) {
      const browser = new Browser(locks);
      const a = await lion(browser);
      const { store: b, warning } = await browser.tab(idOf(a));
      expect(warning).toBeNull();
      expect(idOf(b)).toBe(idOf(a));
    }
  });
});

describe('a browser that is slow to give locks', () => {
  class SlowLocks extends Locks {
    delay_ms = 200; // tabs wait 50 ms for each other
    override async request(name: string, options: { signal: AbortSignal }, held: () => Promise<void>) {
      await new Promise((resolve) => setTimeout(resolve, this.delay_ms));
      options.signal.throwIfAborted();
      await super.request(name, options, held);
    }
  }

  it('opens new projects, which no other tab can have, and then keeps them', async () => {
    const locks = new SlowLocks();
    const browser = new Browser(locks);
    const { store } = await browser.tab();
    await use(store, 'ball');
    await store.create('Shared');
    expect(store.document.value.name).toBe('Shared');
    expect(store.projects.value).toHaveLength(1);
    await use(store, 'torus');
    await store.duplicate();
    expect(store.document.value.name).toBe('Shared copy');
    locks.delay_ms = 0;
    const other = await browser.tab();
    await expect(other.store.open(idOf(store))).rejects.toThrow(/open in another tab/);
  });
});
