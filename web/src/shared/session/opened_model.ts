// SPDX-License-Identifier: GPL-3.0-or-later
// The model of a craft's room: opened from files or the gallery, read for the view.
import type { ReadonlySignal } from '@preact/signals';
import { computed, signal, untracked } from '@preact/signals';
import type { Catalog, JobInput, JsonObject, Operation } from '../../jobs/contract';
import { asJobError, findOperation, JobError } from '../../jobs/contract';
import type { BlobReference } from '../../project/document';
import type { Companion, CraftCommands, CraftDocument, CraftModel, Source, Subject } from './craft_document';
import { modelsElsewhere, nameProject, subjectOf, titleOf } from './craft_document';
import { importModel } from './import_model';
import { readMesh } from './read_mesh';
import { sentences } from './report';
import type { RoomSession } from './room_session';
import type { ShadedMesh } from '../panels/shaded_mesh';
import { formatBytes } from '../../ui';

/** What browsers read into one piece of memory. */
const maxFileBytes = 2 ** 31 - 1;

/** The file's bytes, and of those that came with it. */
export interface ChosenFiles {
  readonly model: File;
  readonly companions?: readonly File[];
}

function modelsAmong(files: readonly File[], catalog: Catalog | null): File[] {
  const extensions = (catalog?.mesh_formats ?? []).map(({ extension }) => `.${extension}`);
  return files.filter(({ name }) => extensions.some((ending) => name.toLowerCase().endsWith(ending)));
}

/** Which of several files dropped together is the model; the others are its materials and pictures. */
function chooseModel(files: readonly File[], catalog: Catalog | null): ChosenFiles | null {
  const model = modelsAmong(files, catalog)[0] ?? files[0];
  return model ? { model, companions: files.filter((file) => file !== model) } : null;
}

export interface OpeningRules<D extends CraftDocument> {
  readonly commands: CraftCommands<D>;
  /** The operation's input for the model. */
  readonly inputName: string;
  /** Inputs beside the model; none without it. */
  readonly furtherInputs?: ReadonlySignal<Readonly<Record<string, JobInput>>>;
  /** What a new model says of itself; nothing without it. */
  readonly ownParameters?: (source: Source) => JsonObject;
  /** Which parameters belonged to the old model. */
  readonly forgets: (name: string) => boolean;
}

export class OpenedModel<D extends CraftDocument = CraftDocument> {
  readonly original = signal<{ readonly mesh: ShadedMesh; readonly from: string } | null>(null);
  /** Repairs of the model just opened, until dismissed. */
  readonly repairsOpen = signal(false);
  readonly isThere = computed(() => this.#room.document.value.model !== null);
  /** What a full solve is about. */
  readonly subject = computed(() => {
    const { model } = this.#room.document.value;
    return model && this.#subjectOf(model.mesh);
  });
  /** What previews are made of. */
  readonly previewSubject = computed(() => {
    const { model } = this.#room.document.value;
    return model && this.#subjectOf(model.preview);
  });
  /** Models that other rooms of the project have, each once. */
  readonly elsewhere = computed(() =>
    modelsElsewhere(this.#room.services.projects.document.value, this.#rules.commands.craft),
  );
  readonly #room: RoomSession<D>;
  readonly #rules: OpeningRules<D>;

  constructor(room: RoomSession<D>, rules: OpeningRules<D>) {
    this.#room = room;
    this.#rules = rules;
  }

  #subjectOf(mesh: BlobReference): Subject {
    return subjectOf(mesh, this.#rules.inputName, this.#rules.furtherInputs?.value ?? {});
  }

  /** Those whose names say that they are models. */
  modelsAmong(files: readonly File[]): File[] {
    return modelsAmong(files, this.#room.services.catalog.value);
  }

  async openFiles(files: readonly File[]): Promise<boolean> {
    const chosen = chooseModel(files, this.#room.services.catalog.value);
    return chosen !== null && (await this.openFile(chosen));
  }

  async openFile({ model, companions = [] }: ChosenFiles): Promise<boolean> {
    const large = [model, ...companions].find(({ size }) => size > maxFileBytes);
    if (large) {
      const message = `It has ${formatBytes(large.size)}, and a browser reads files up to ${formatBytes(maxFileBytes)}: reduce the number of triangles and export it again.`;
      this.#room.problem.value = { kind: 'file', title: `Could not open ${large.name}`, message };
      return false;
    }
    const reference = async (file: File): Promise<BlobReference> =>
      await this.#room.keep(
        new Uint8Array(await file.arrayBuffer()),
        file.type || 'application/octet-stream',
      );
    return await this.#open(model.name, async () => {
      const file = await reference(model);
      const kept: Companion[] = [];
      for (const other of companions) kept.push({ file_name: other.name, file: await reference(other) });
      return { kind: 'file', file_name: model.name, file, ...(kept.length > 0 ? { companions: kept } : {}) };
    });
  }

  /** Opens a model that another room has read. */
  take(model: CraftModel): void {
    const operation = this.#room.operation.value;
    if (operation === null) return;
    const { projects } = this.#room.services;
    projects.do(this.#openCommand(operation, model, titleOf(model.source)));
    projects.commit();
  }

  /** The same model changed: its viewpoint and everything else stay. */
  async change(
    source: Source,
    label: string,
    signal: AbortSignal,
    also: (model: CraftModel) => (craft: D) => Partial<D>,
  ): Promise<void> {
    const change = this.#room.changesHere();
    const { browser, projects } = this.#room.services;
    const model = await importModel(browser, projects.blobs, source, { signal });
    change(this.#rules.commands.changeModel(model, label, also(model)));
    projects.commit();
  }

  #openCommand(operation: Operation, model: CraftModel, name: string) {
    return this.#rules.commands.openModel(
      operation,
      model,
      `Open ${name}`,
      this.#rules.ownParameters?.(model.source) ?? {},
      this.#rules.forgets,
    );
  }

  async openSample(sample: string, title: string): Promise<boolean> {
    return await this.#open(title, () => Promise.resolve({ kind: 'sample', sample, title }));
  }

  async #open(name: string, getSource: () => Promise<Source>): Promise<boolean> {
    const opened = await this.#room.busy(
      'opening',
      name,
      async (options) => {
        const { browser, projects } = this.#room.services;
        const operation = await this.#needOperation();
        const model: CraftModel = await importModel(browser, projects.blobs, await getSource(), options);
        const first = projects.isBlank.value && projects.document.value.name === 'New project';
        options.do(this.#openCommand(this.#room.operation.value ?? operation, model, name));
        if (first) options.do(nameProject(name.replace(/\.[^.]+$/, '')));
        this.repairsOpen.value = sentences(model.report, 'repairs').length > 0;
        return true;
      },
      ({ message }) =>
        (this.#room.problem.value = { kind: 'file', title: `Could not open ${name}`, message }),
    );
    return opened ?? false;
  }

  /** Reads the model's mesh, named by its hash, for the view. */
  async load(from: string | null): Promise<void> {
    if (from === null) {
      this.original.value = null;
      return;
    }
    if (untracked(() => this.original.value?.from) === from) return;
    try {
      const mesh = await readMesh(await this.#room.services.projects.blobs.read(from));
      if (this.#room.document.value.model?.mesh.blob === from) this.original.value = { mesh, from };
    } catch (thrown) {
      this.#room.problem.value = {
        kind: 'file',
        title: 'The model is missing',
        message: asJobError(thrown).message,
      };
    }
  }

  async #needOperation(): Promise<Operation> {
    const catalog = this.#room.services.catalog.value ?? (await this.#room.services.browser.catalog());
    const operation = findOperation(catalog, this.#room.operationName);
    if (operation === undefined)
      throw new JobError({
        code: 'internal',
        where: '',
        message: `This version of Formwright cannot do this (${this.#room.operationName}).`,
      });
    return operation;
  }

  get title(): string {
    const model = this.#room.document.value.model;
    return model === null ? this.#rules.commands.craft : titleOf(model.source).replace(/\.[^.]+$/, '');
  }
}

/** A room with a model. */
export type ModelRoom<D extends CraftDocument = CraftDocument> = RoomSession<D> & {
  readonly model: OpenedModel<D>;
};
