// SPDX-License-Identifier: GPL-3.0-or-later
// Where projects and blobs are kept in this browser: the origin's private file system, or IndexedDB
// where that cannot be written.

export interface ProjectStorage {
  readonly kind: 'opfs' | 'indexeddb' | 'memory';
  readProjects(): Promise<unknown[]>;
  writeProject(id: string, document: object): Promise<void>;
  deleteProject(id: string): Promise<void>;
  /** Null when it is not there. */
  readBlob(sha256: string): Promise<Uint8Array<ArrayBuffer> | null>;
  hasBlob(sha256: string): Promise<boolean>;
  writeBlob(sha256: string, bytes: Uint8Array<ArrayBuffer>): Promise<void>;
  listBlobs(): Promise<string[]>;
  deleteBlob(sha256: string): Promise<void>;
}

/** A storage error as a sentence that names the mend. */
export function storageSentence(thrown: unknown): string {
  const name = thrown instanceof Error ? thrown.name : '';
  if (name === 'QuotaExceededError')
    return 'The browser has no room left for this project. Delete projects you no longer need, or save this one as a file.';
  if (name === 'SecurityError' || name === 'InvalidStateError')
    return 'This browser does not let the page keep files, as in a private window. Save the project as a file before you close the tab.';
  return 'The project could not be saved in the browser. Save it as a file before closing.';
}

export class MemoryStorage implements ProjectStorage {
  readonly kind: ProjectStorage['kind'] = 'memory';
  readonly #projects = new Map<string, string>();
  readonly #blobs = new Map<string, Uint8Array<ArrayBuffer>>();

  readProjects = () =>
    Promise.resolve([...this.#projects.values()].map((text) => JSON.parse(text) as unknown));
  async writeProject(id: string, document: object): Promise<void> {
    this.#projects.set(id, JSON.stringify(document));
  }
  async deleteProject(id: string): Promise<void> {
    this.#projects.delete(id);
  }
  readBlob = (sha256: string) => Promise.resolve(this.#blobs.get(sha256) ?? null);
  hasBlob = (sha256: string) => Promise.resolve(this.#blobs.has(sha256));
  async writeBlob(sha256: string, bytes: Uint8Array<ArrayBuffer>): Promise<void> {
    this.#blobs.set(sha256, bytes);
  }
  listBlobs = () => Promise.resolve([...this.#blobs.keys()]);
  async deleteBlob(sha256: string): Promise<void> {
    this.#blobs.delete(sha256);
  }
}
