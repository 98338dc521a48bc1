// SPDX-License-Identifier: GPL-3.0-or-later
// The open project and its siblings, as signals: every change is a command; what changed is saved by
// itself half a second after the last change.
import { computed, signal } from '@preact/signals';
import { packProject, unpackProject } from './archive';
import type { BlobStore } from './blob_store';
import type { ProjectDocument } from './document';
import { asDocument, blobsOf, newDocument } from './document';
import type { Command } from './history';
import { History } from './history';
import type { ProjectStorage } from './storage';
import { storageSentence } from './storage';

export type SaveState =
  { readonly state: 'saved' | 'saving' | 'unsaved' } | { readonly state: 'failed'; readonly message: string };

export interface ProjectSummary {
  readonly id: string;
  readonly name: string;
  readonly modified_unix_s: number;
}

interface Stored {
  readonly document: ProjectDocument;
  readonly modified_unix_s: number;
}

const saveDelay_ms = 500;
const now_s = () => Math.round(Date.now() / 1000);

export class ProjectStore {
  readonly blobs: BlobStore;
  readonly #storage: ProjectStorage;
  readonly #stored = new Map<string, Stored>();
  #history: History<ProjectDocument>;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #saving: Promise<void> = Promise.resolve();

  readonly document = signal<ProjectDocument>(newDocument('', '', 0));
  readonly saveState = signal<SaveState>({ state: 'saved' });
  readonly undoLabel = signal<string | null>(null);
  readonly redoLabel = signal<string | null>(null);
  readonly projects = signal<readonly ProjectSummary[]>([]);
  /** Nothing has been made in it yet: such a project is not listed and not kept. */
  readonly isBlank = computed(() => Object.keys(this.document.value.crafts).length === 0);

  constructor(storage: ProjectStorage, blobs: BlobStore) {
    this.#storage = storage;
    this.blobs = blobs;
    this.#history = new History(newDocument(crypto.randomUUID(), 'New project', now_s()));
    this.#publish();
  }

  /** Reads what is stored and opens `id`, or the last project worked on. */
  async load(id: string | null): Promise<void> {
    for (const value of await this.#storage.readProjects()) {
      try {
        const { document, modified_unix_s } = value as Stored;
        this.#stored.set(document.id, { document: asDocument(document), modified_unix_s });
      } catch {
        // A document of a newer version stays where it is, untouched.
      }
    }
    this.#list();
    const open = id === null ? undefined : this.#stored.get(id);
    if (open) this.#adopt(open.document);
  }

  do(command: Command<ProjectDocument>): void {
    if (!this.#history.do(command)) return;
    this.#publish();
    this.#scheduleSave();
  }
  /** Ends a run of coalesced commands: a slider was let go. */
  commit(): void {
    this.#history.commit();
  }
  undo(): void {
    if (this.#history.undo()) this.#changed();
  }
  redo(): void {
    if (this.#history.redo()) this.#changed();
  }

  rename(name: string): void {
    const label = 'Rename the project';
    this.do({ label, apply: (document) => ({ ...document, name: name.trim() || document.name }) });
  }
  async create(name = 'New project'): Promise<void> {
    await this.flush();
    this.#adopt(newDocument(crypto.randomUUID(), name, now_s()));
  }
  async open(id: string): Promise<void> {
    await this.flush();
    const stored = this.#stored.get(id);
    if (stored) this.#adopt(stored.document);
  }
  async duplicate(): Promise<void> {
    await this.flush();
    const { document } = this.#history;
    await this.#adoptNew({ ...document, id: crypto.randomUUID(), name: `${document.name} copy` });
  }
  async remove(id: string): Promise<void> {
    if (id === this.document.value.id) {
      clearTimeout(this.#timer);
      await this.#saving;
    }
    await this.#storage.deleteProject(id);
    this.#stored.delete(id);
    this.#list();
    if (id === this.document.value.id) this.#adopt(newDocument(crypto.randomUUID(), 'New project', now_s()));
    await this.sweep();
  }
  async exportFile(): Promise<Uint8Array<ArrayBuffer>> {
    return await packProject(this.#history.document, this.blobs);
  }
  async importFile(bytes: Uint8Array<ArrayBuffer>): Promise<void> {
    const document = await unpackProject(bytes, this.blobs);
    await this.flush();
    const taken = this.#stored.has(document.id);
    await this.#adoptNew(taken ? { ...document, id: crypto.randomUUID() } : document);
  }
  /** Deletes the blobs that no stored or open project names. */
  async sweep(): Promise<void> {
    const used = blobsOf(this.#history.document);
    for (const { document } of this.#stored.values()) blobsOf(document, used);
    await this.blobs.sweep(used);
  }

  /** Saves now, if anything is unsaved. */
  async flush(): Promise<void> {
    clearTimeout(this.#timer);
    if (this.saveState.value.state !== 'saved') this.#saving = this.#saving.then(() => this.#save());
    await this.#saving;
  }

  #changed(): void {
    this.#publish();
    this.#scheduleSave();
  }
  #scheduleSave(): void {
    if (this.isBlank.value) return;
    this.saveState.value = { state: 'unsaved' };
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.flush(), saveDelay_ms);
  }
  async #save(): Promise<void> {
    const { document } = this.#history;
    const stored: Stored = { document, modified_unix_s: now_s() };
    this.saveState.value = { state: 'saving' };
    try {
      await this.#storage.writeProject(document.id, stored);
      this.#stored.set(document.id, stored);
      this.#list();
      if (this.#history.document === document) this.saveState.value = { state: 'saved' };
    } catch (thrown) {
      this.saveState.value = { state: 'failed', message: storageSentence(thrown) };
    }
  }
  async #adoptNew(document: ProjectDocument): Promise<void> {
    this.#adopt(document);
    this.saveState.value = { state: 'unsaved' };
    await this.flush();
  }
  #adopt(document: ProjectDocument): void {
    this.#history = new History(document);
    this.saveState.value = { state: 'saved' };
    this.#publish();
  }
  #publish(): void {
    this.document.value = this.#history.document;
    this.undoLabel.value = this.#history.undoLabel;
    this.redoLabel.value = this.#history.redoLabel;
  }
  #list(): void {
    this.projects.value = [...this.#stored.values()]
      .map(({ document, modified_unix_s }) => ({ id: document.id, name: document.name, modified_unix_s }))
      .sort((a, b) => b.modified_unix_s - a.modified_unix_s);
  }
}
