// SPDX-License-Identifier: GPL-3.0-or-later
// Blobs by their hash: what was used last stays in memory, everything worth keeping goes to storage.
import { sha256Hex } from '../jobs/hash';
import type { ProjectStorage } from './storage';

const memoryLimit_bytes = 256 * 2 ** 20;

export class BlobStore {
  readonly #storage: ProjectStorage;
  readonly #hash: (bytes: Uint8Array<ArrayBuffer>) => Promise<string>;
  readonly #recent = new Map<string, Uint8Array<ArrayBuffer>>();
  /** In memory only, and not let go of. */
  readonly #unsaved = new Set<string>();
  #recentBytes = 0;

  constructor(storage: ProjectStorage, hash = sha256Hex) {
    this.#storage = storage;
    this.#hash = hash;
  }

  /** Keeps the bytes; returns their hash once they can be read again. Throws the storage's error: then they
   *  stay in memory until the page closes, and saveHeld tries again. */
  async put(bytes: Uint8Array<ArrayBuffer>): Promise<string> {
    const sha256 = await this.hold(bytes);
    await this.#store(sha256, bytes);
    return sha256;
  }

  /** Writes those of `named` that are in memory only: there was no room for them, or another tab deleted them
   *  before this project said that it uses them. Throws the storage's error. */
  async saveHeld(named: Iterable<string>): Promise<void> {
    for (const sha256 of named) {
      const bytes = this.#recent.get(sha256);
      if (bytes !== undefined) await this.#store(sha256, bytes);
    }
  }

  /** Keeps the bytes in memory only, as long as there is room. */
  async hold(bytes: Uint8Array<ArrayBuffer>): Promise<string> {
    const sha256 = await this.#hash(bytes);
    this.#remember(sha256, bytes);
    return sha256;
  }

  async read(sha256: string): Promise<Uint8Array<ArrayBuffer>> {
    const bytes = this.#recent.get(sha256) ?? (await this.#storage.readBlob(sha256));
    if (bytes === null) throw new Error('A file of this project is missing; open the model again.');
    this.#remember(sha256, bytes);
    return bytes;
  }

  async has(sha256: string): Promise<boolean> {
    return this.#recent.has(sha256) || (await this.#storage.hasBlob(sha256));
  }

  /** Deletes every stored blob that is not in `used`, nor in memory, where one waits to be named. */
  async sweep(used: ReadonlySet<string>): Promise<void> {
    for (const sha256 of await this.#storage.listBlobs())
      if (!used.has(sha256) && !this.#recent.has(sha256)) await this.#storage.deleteBlob(sha256);
  }

  /** Deletes these from storage: no project names them any more. */
  async forget(unused: Iterable<string>): Promise<void> {
    for (const sha256 of unused) {
      this.#unsaved.delete(sha256);
      await this.#storage.deleteBlob(sha256);
    }
  }

  async #store(sha256: string, bytes: Uint8Array<ArrayBuffer>): Promise<void> {
    this.#unsaved.add(sha256);
    if (!(await this.#storage.hasBlob(sha256))) await this.#storage.writeBlob(sha256, bytes);
    this.#unsaved.delete(sha256);
  }
  #remember(sha256: string, bytes: Uint8Array<ArrayBuffer>): void {
    this.#recentBytes += bytes.byteLength - (this.#recent.get(sha256)?.byteLength ?? 0);
    this.#recent.delete(sha256);
    this.#recent.set(sha256, bytes);
    for (const [oldest, { byteLength }] of this.#recent) {
      if (this.#recentBytes <= memoryLimit_bytes || oldest === sha256) break;
      if (this.#unsaved.has(oldest)) continue;
      this.#recent.delete(oldest);
      this.#recentBytes -= byteLength;
    }
  }
}
