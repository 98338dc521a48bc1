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
import { ProjectLocks } from './project_locks';
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
  /** What is saved is still there when the page is opened again. */
  readonly lasts: boolean;
  readonly #storage: ProjectStorage;
  readonly #locks: ProjectLocks;
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

  constructor(storage: ProjectStorage, blobs: BlobStore, locks = new ProjectLocks()) {
    this.#storage = storage;
    this.lasts = storage.kind !== 'memory';
    this.#locks = locks;
    this.blobs = blobs;
    this.#history = new History(newDocument(crypto.randomUUID(), 'New project', now_s()));
    this.#publish();
  }

  /** Reads what is stored and opens `id`. Where another tab has it open a new project is here instead, and a
   *  sentence says why. */
  async load(id: string | null): Promise<string | null> {
    const taken = id !== null && !(await this.#locks.take(id));
    await this.#readStored(); // the tab that let go of it has saved it by now
    const stored = id === null ? undefined : this.#stored.get(id);
    if (stored && !taken) this.#adopt(stored.document);
    else {
      if (id !== null && !taken) this.#locks.release(id);
      void this.#locks.takeNew(this.document.value.id); // nobody else can have it: the page need not wait
    }
    return stored && taken
      ? `“${stored.document.name}” is open in another tab; here is a new project.`
      : null;
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
  /** These four leave the open project. Where it cannot be saved they throw a sentence, and it stays open. */
  async create(name = 'New project'): Promise<void> {
    const document = newDocument(crypto.randomUUID(), name, now_s());
    await this.#turnTo(document.id, () => document, true);
  }
  async open(id: string): Promise<void> {
    if (id === this.document.value.id) return;
    await this.#turnTo(id, async () => {
      await this.#readStored(); // another tab may have changed it since this one has read it
      const stored = this.#stored.get(id);
      if (!stored) throw new Error('This project was deleted in another tab.');
      return stored.document;
    });
  }
  async duplicate(): Promise<void> {
    const id = crypto.randomUUID();
    const copy = () => {
      const { document } = this.#history;
      return { ...document, id, name: `${document.name} copy` };
    };
    await this.#turnTo(id, copy, true);
    await this.#saveNew();
  }
  async importFile(bytes: Uint8Array<ArrayBuffer>): Promise<void> {
    await this.#saveFirst(); // before the file takes room
    const document = await unpackProject(bytes, this.blobs);
    await this.#readStored();
    const taken = this.#stored.has(document.id) || !(await this.#locks.take(document.id));
    const id = taken ? crypto.randomUUID() : document.id;
    await this.#turnTo(id, () => ({ ...document, id }), taken);
    await this.#saveNew();
  }
  /** Possible whatever the open project's state: it is the way out of a full disk. */
  async remove(id: string): Promise<void> {
    const gone = blobsOf(this.#stored.get(id)?.document);
    if (id === this.document.value.id) {
      const next = newDocument(crypto.randomUUID(), 'New project', now_s());
      await this.#locks.takeNew(next.id);
      clearTimeout(this.#timer);
      this.#named(gone);
      this.#adopt(next); // first, so that nothing more is saved of what is being deleted
      await this.#saving;
    } else await this.#take(id);
    try {
      await this.#storage.deleteProject(id);
    } finally {
      this.#locks.release(id);
    }
    this.#stored.delete(id);
    this.#list();
    const used = await this.#used();
    await this.blobs.forget([...gone].filter((blob) => !used.has(blob)));
    await this.flush(); // there may be room now
  }
  async exportFile(): Promise<Uint8Array<ArrayBuffer>> {
    return await packProject(this.#history.document, this.blobs);
  }
  /** Deletes the blobs that no stored or open project names. */
  async sweep(): Promise<void> {
    await this.blobs.sweep(await this.#used());
  }

  /** Saves now, if anything is unsaved. */
  async flush(): Promise<void> {
    clearTimeout(this.#timer);
    const { state } = this.saveState.value;
    if (state === 'unsaved' || state === 'failed') this.#saving = this.#saving.then(() => this.#save());
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
    const report = (state: SaveState) => {
      if (this.#history.document.id === document.id) this.saveState.value = state;
    };
    report({ state: 'saving' });
    try {
      await this.blobs.saveHeld(blobsOf(document)); // what is stored never names what is not
      await this.#storage.writeProject(document.id, stored);
      this.#stored.set(document.id, stored);
      this.#list();
      report({ state: this.#history.document === document ? 'saved' : 'unsaved' });
    } catch (thrown) {
      report({ state: 'failed', message: storageSentence(thrown) });
    }
  }
  async #saveNew(): Promise<void> {
    this.saveState.value = { state: 'unsaved' };
    await this.flush();
  }
  /** Throws a sentence where what is open cannot be saved. */
  async #saveFirst(): Promise<void> {
    do await this.flush();
    while (['unsaved', 'saving'].includes(this.saveState.value.state)); // it was changed meanwhile
    const save = this.saveState.value;
    if (save.state === 'failed' && !this.isBlank.value)
      throw new Error(`This project is not saved yet, so it stays open. ${save.message}`);
  }
  async #take(id: string): Promise<void> {
    if (await this.#locks.take(id)) return;
    const name = this.#stored.get(id)?.document.name ?? 'This project';
    throw new Error(
      `“${name}” is open in another tab. Continue there, or open another project in that tab first.`,
    );
  }
  async #turnTo(
    id: string,
    next: () => ProjectDocument | Promise<ProjectDocument>,
    isNew = false,
  ): Promise<void> {
    await (isNew ? this.#locks.takeNew(id) : this.#take(id));
    try {
      const document = await next();
      await this.#saveFirst(); // nothing else is waited for before #adopt: nothing can change
      const { id: left } = this.document.value;
      if (left === id) return; // asked for twice
      this.#adopt(document);
      this.#locks.release(left);
    } catch (thrown) {
      if (this.document.value.id !== id) this.#locks.release(id);
      throw thrown;
    }
  }
  #adopt(document: ProjectDocument): void {
    this.#history = new History(document);
    this.saveState.value = { state: 'saved' };
    this.#publish();
  }
  async #readStored(): Promise<void> {
    const values = await this.#storage.readProjects();
    this.#stored.clear();
    for (const value of values) {
      try {
        const { document, modified_unix_s } = value as Stored;
        this.#stored.set(document.id, { document: asDocument(document), modified_unix_s });
      } catch {
        // A document of a newer version stays where it is, untouched.
      }
    }
    this.#list();
  }
  /** The blobs of the open project, those that undo can bring back included. */
  #named(found = new Set<string>()): Set<string> {
    for (const value of this.#history.values()) blobsOf(value, found);
    return found;
  }
  /** Blobs in use, by what is on disk now: other tabs have saved, newer versions are not read here. */
  async #used(): Promise<Set<string>> {
    const used = this.#named();
    for (const value of await this.#storage.readProjects()) blobsOf(value, used);
    return used;
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
