// SPDX-License-Identifier: GPL-3.0-or-later
// What every craft's page does with its model: opens it, reads it for the view.
import type { ReadonlySignal } from '@preact/signals';
import { computed, signal, untracked } from '@preact/signals';
import type { Catalog, JobInput, JsonObject, Operation } from '../../jobs/contract';
import { asJobError, findOperation, JobError } from '../../jobs/contract';
import type { BlobReference } from '../../project/document';
import type { Companion, CraftCommands, CraftDocument, CraftModel, Source } from './craft_document';
import { nameProject, subjectOf, titleOf } from './craft_document';
import { importModel } from './import_model';
import { readMesh } from './read_mesh';
import { sentences } from './report';
import { RoomSession } from './room_session';
import type { ShadedMesh } from './shaded_mesh';

/** The file's bytes, and of those that came with it. */
export interface ChosenFiles {
  readonly model: File;
  readonly companions?: readonly File[];
}

/** Which of several files dropped together is the model; the others are its materials and pictures. */
function chooseModel(files: readonly File[], catalog: Catalog | null): ChosenFiles | null {
  const extensions = (catalog?.mesh_formats ?? []).map(({ extension }) => `.${extension}`);
  const isModel = ({ name }: File) => extensions.some((ending) => name.toLowerCase().endsWith(ending));
  const model = files.find(isModel) ?? files[0];
  return model ? { model, companions: files.filter((file) => file !== model) } : null;
}

export abstract class CraftSession<D extends CraftDocument = CraftDocument> extends RoomSession<D> {
  declare readonly commands: CraftCommands<D>;
  readonly original = signal<{ readonly mesh: ShadedMesh; readonly from: string } | null>(null);
  /** Repairs of the model just opened, until dismissed. */
  readonly repairsOpen = signal(false);
  readonly hasWork = computed(() => this.document.value.model !== null);
  /** The operation's input for the model. */
  abstract readonly meshInputName: string;
  /** Inputs beside the model. */
  readonly furtherInputs: ReadonlySignal<Readonly<Record<string, JobInput>>> = signal({});
  readonly subject = computed(() => {
    const { model } = this.document.value;
    return model && subjectOf(model.mesh, this.meshInputName, this.furtherInputs.value);
  });

  /** What a new model says of itself, and which parameters belonged to the old one. */
  protected abstract ownParameters(source: Source): JsonObject;
  protected abstract forgets(name: string): boolean;
  // ---- models ----

  async openFiles(files: readonly File[]): Promise<boolean> {
    const chosen = chooseModel(files, this.services.catalog.value);
    return chosen !== null && (await this.openFile(chosen));
  }

  async openFile({ model, companions = [] }: ChosenFiles): Promise<boolean> {
    const reference = async (file: File): Promise<BlobReference> =>
      await this.keep(new Uint8Array(await file.arrayBuffer()), file.type || 'application/octet-stream');
    return await this.#open(model.name, async () => {
      const file = await reference(model);
      const kept: Companion[] = [];
      for (const other of companions) kept.push({ file_name: other.name, file: await reference(other) });
      return { kind: 'file', file_name: model.name, file, ...(kept.length > 0 ? { companions: kept } : {}) };
    });
  }

  async openSample(sample: string, title: string): Promise<boolean> {
    return await this.#open(title, () => Promise.resolve({ kind: 'sample', sample, title }));
  }

  async #open(name: string, getSource: () => Promise<Source>): Promise<boolean> {
    const opened = await this.busy(
      'opening',
      name,
      async (options) => {
        const { browser, projects } = this.services;
        const operation = await this.#needOperation();
        const model: CraftModel = await importModel(browser, projects.blobs, await getSource(), options);
        const first = projects.isBlank.value && projects.document.value.name === 'New project';
        options.do(
          this.commands.openModel(
            this.operation.value ?? operation,
            model,
            `Open ${name}`,
            this.ownParameters(model.source),
            (parameter) => this.forgets(parameter),
          ),
        );
        if (first) options.do(nameProject(name.replace(/\.[^.]+$/, '')));
        this.repairsOpen.value = sentences(model.report, 'repairs').length > 0;
        return true;
      },
      ({ message }) => (this.problem.value = { kind: 'file', title: `Could not open ${name}`, message }),
    );
    return opened ?? false;
  }

  protected async loadOriginal(from: string | null): Promise<void> {
    if (from === null) {
      this.original.value = null;
      return;
    }
    if (untracked(() => this.original.value?.from) === from) return;
    try {
      const mesh = await readMesh(await this.services.projects.blobs.read(from));
      if (this.document.value.model?.mesh.blob === from) this.original.value = { mesh, from };
    } catch (thrown) {
      this.problem.value = {
        kind: 'file',
        title: 'The model is missing',
        message: asJobError(thrown).message,
      };
    }
  }

  async #needOperation(): Promise<Operation> {
    const catalog = this.services.catalog.value ?? (await this.services.browser.catalog());
    const operation = findOperation(catalog, this.operationName);
    if (operation === undefined)
      throw new JobError({
        code: 'internal',
        where: '',
        message: `This build has no operation ${this.operationName}.`,
      });
    return operation;
  }

  get title(): string {
    const model = this.document.value.model;
    return model === null ? this.commands.craft : titleOf(model.source).replace(/\.[^.]+$/, '');
  }
}
