// SPDX-License-Identifier: GPL-3.0-or-later
import type { ProjectStorage } from './storage';

const settled = <T>(request: IDBRequest<T>): Promise<T> =>
  new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error ?? new Error('IndexedDB failed.'));
  });

export class IndexedDbStorage implements ProjectStorage {
  readonly kind = 'indexeddb';
  readonly #database: IDBDatabase;

  private constructor(database: IDBDatabase) {
    this.#database = database;
  }

  static async open(name = 'formwright'): Promise<IndexedDbStorage> {
    const request = indexedDB.open(name, 1);
    request.onupgradeneeded = () => {
      request.result.createObjectStore('projects');
      request.result.createObjectStore('blobs');
    };
    return new IndexedDbStorage(await settled(request));
  }

  #store(name: 'projects' | 'blobs', mode: IDBTransactionMode): IDBObjectStore {
    return this.#database.transaction(name, mode).objectStore(name);
  }
  /** Resolves when the change is on disk. */
  #change(name: 'projects' | 'blobs', change: (store: IDBObjectStore) => void): Promise<void> {
    const transaction = this.#database.transaction(name, 'readwrite');
    change(transaction.objectStore(name));
    return new Promise((resolve, reject) => {
      transaction.oncomplete = () => resolve();
      transaction.onabort = () => reject(transaction.error ?? new Error('IndexedDB failed.'));
    });
  }

  readProjects = (): Promise<unknown[]> => settled(this.#store('projects', 'readonly').getAll());
  writeProject = (id: string, document: object) =>
    this.#change('projects', (store) => store.put(document, id));
  deleteProject = (id: string) => this.#change('projects', (store) => store.delete(id));
  async readBlob(sha256: string): Promise<Uint8Array<ArrayBuffer> | null> {
    const found = (await settled(this.#store('blobs', 'readonly').get(sha256))) as
      Uint8Array<ArrayBuffer> | undefined;
    return found ?? null;
  }
  async hasBlob(sha256: string): Promise<boolean> {
    return (await settled(this.#store('blobs', 'readonly').count(sha256))) > 0;
  }
  writeBlob = (sha256: string, bytes: Uint8Array<ArrayBuffer>) =>
    this.#change('blobs', (store) => store.put(bytes, sha256));
  async listBlobs(): Promise<string[]> {
    return (await settled(this.#store('blobs', 'readonly').getAllKeys())) as string[];
  }
  deleteBlob = (sha256: string) => this.#change('blobs', (store) => store.delete(sha256));
}
