// SPDX-License-Identifier: GPL-3.0-or-later
import type { ProjectStorage } from './storage';

const hashOfNothing = 'e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855';
const isNotFound = (thrown: unknown) => thrown instanceof DOMException && thrown.name === 'NotFoundError';

async function writeFile(folder: FileSystemDirectoryHandle, name: string, content: FileSystemWriteChunkType) {
  const file = await folder.getFileHandle(name, { create: true });
  const writable = await file.createWritable(); // written aside, and swapped in by close()
  try {
    await writable.write(content);
    await writable.close();
  } catch (thrown) {
    await writable.abort().catch(() => undefined);
    const size = await file.getFile().then(
      (f) => f.size,
      () => 0,
    );
    if (size === 0) await folder.removeEntry(name).catch(() => undefined);
    throw thrown;
  }
}

export class OpfsStorage implements ProjectStorage {
  readonly kind = 'opfs';
  readonly #projects: FileSystemDirectoryHandle;
  readonly #blobs: FileSystemDirectoryHandle;

  private constructor(projects: FileSystemDirectoryHandle, blobs: FileSystemDirectoryHandle) {
    this.#projects = projects;
    this.#blobs = blobs;
  }

  /** Throws where the private file system is missing or cannot be written from the page. */
  static async open(): Promise<OpfsStorage> {
    const root = await navigator.storage.getDirectory();
    const projects = await root.getDirectoryHandle('projects', { create: true });
    const blobs = await root.getDirectoryHandle('blobs', { create: true });
    await writeFile(root, 'probe', 'x').catch((thrown: unknown) => {
      // On a full disk the projects are still here, and can be deleted to make room.
      if (!(thrown instanceof DOMException) || thrown.name !== 'QuotaExceededError') throw thrown;
    });
    return new OpfsStorage(projects, blobs);
  }

  async readProjects(): Promise<unknown[]> {
    const found: unknown[] = [];
    for await (const handle of this.#projects.values()) {
      if (handle.kind !== 'file' || !handle.name.endsWith('.json')) continue;
      try {
        found.push(JSON.parse(await (await handle.getFile()).text()));
      } catch {
        // A file that was cut short; the other projects are still good.
      }
    }
    return found;
  }
  writeProject(id: string, document: object): Promise<void> {
    return writeFile(this.#projects, `${id}.json`, JSON.stringify(document));
  }
  async deleteProject(id: string): Promise<void> {
    await this.#projects.removeEntry(`${id}.json`).catch((thrown: unknown) => {
      if (!isNotFound(thrown)) throw thrown;
    });
  }
  async readBlob(sha256: string): Promise<Uint8Array<ArrayBuffer> | null> {
    try {
      const handle = await this.#blobs.getFileHandle(sha256);
      return new Uint8Array(await (await handle.getFile()).arrayBuffer());
    } catch (thrown) {
      if (isNotFound(thrown)) return null;
      throw thrown;
    }
  }
  async hasBlob(sha256: string): Promise<boolean> {
    try {
      // A file is there, without content, before it is written: where the page ended between the two it holds nothing.
      const { size } = await (await this.#blobs.getFileHandle(sha256)).getFile();
      return size > 0 || sha256 === hashOfNothing;
    } catch {
      return false;
    }
  }
  writeBlob(sha256: string, bytes: Uint8Array<ArrayBuffer>): Promise<void> {
    return writeFile(this.#blobs, sha256, bytes);
  }
  async listBlobs(): Promise<string[]> {
    const names: string[] = [];
    for await (const name of this.#blobs.keys()) if (/^[0-9a-f]{64}$/.test(name)) names.push(name);
    return names;
  }
  async deleteBlob(sha256: string): Promise<void> {
    await this.#blobs.removeEntry(sha256).catch(() => undefined);
  }
}
