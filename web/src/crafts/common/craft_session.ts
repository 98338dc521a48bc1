// SPDX-License-Identifier: GPL-3.0-or-later
// What every craft's page does with its model: opens it, runs one task at a time that the strip shows and Esc
// cancels, says what went wrong. It holds no state that matters; that is in the project document.
import type { ReadonlySignal } from '@preact/signals';
import { signal, untracked } from '@preact/signals';
import type { Catalog, Json, JsonObject, Operation, Progress, Report } from '../../jobs/contract';
import { asJobError, findOperation, JobError } from '../../jobs/contract';
import type { BlobReference } from '../../project/document';
import { jsonEqual } from '../../project/document';
import type {
  Companion,
  CraftCommands,
  CraftDocument,
  CraftModel,
  CraftResult,
  Source,
} from './craft_document';
import { inForce, nameProject, requestKey, titleOf } from './craft_document';
import type { Measured } from './estimate';
import { importModel, keep as keepBytes } from './import_model';
import { readMesh } from './read_mesh';
import { sentences } from './report';
import type { Services } from './services';
import type { ShadedMesh } from './shaded_mesh';

/** What the strip shows and Esc cancels. */
export type Activity =
  | { readonly kind: 'idle' }
  | {
      readonly kind: 'opening' | 'solving' | 'exporting';
      /** The file or format concerned, or the backend. */
      readonly name: string;
      readonly progress: Progress | null;
    };

export interface BusyOptions {
  readonly signal: AbortSignal;
  readonly onProgress: (progress: Progress) => void;
}

export interface Problem {
  readonly title: string;
  readonly message: string;
  readonly kind: 'file' | 'solve';
}

/** The file's bytes, and of those that came with it. */
export interface ChosenFiles {
  readonly model: File;
  readonly companions?: readonly File[];
}

/** Which of several files dropped together is the model; the others are its materials and pictures. */
export function chooseModel(files: readonly File[], catalog: Catalog | null): ChosenFiles | null {
  const extensions = (catalog?.mesh_formats ?? []).map(({ extension }) => `.${extension}`);
  const isModel = ({ name }: File) => extensions.some((ending) => name.toLowerCase().endsWith(ending));
  const model = files.find(isModel) ?? files[0];
  return model ? { model, companions: files.filter((file) => file !== model) } : null;
}

export abstract class CraftSession<D extends CraftDocument = CraftDocument> {
  readonly services: Services;
  readonly commands: CraftCommands<D>;
  abstract readonly document: ReadonlySignal<D>;
  /** All parameters that the page offers. */
  abstract readonly operation: ReadonlySignal<Operation | null>;
  readonly original = signal<{ readonly mesh: ShadedMesh; readonly from: string } | null>(null);
  /** Its page is looked at: only then is anything kept up to date. */
  readonly active = signal(false);
  readonly activity = signal<Activity>({ kind: 'idle' });
  readonly problem = signal<Problem | null>(null);
  readonly fieldErrors = signal<Readonly<Record<string, string>>>({});
  /** Repairs of the model just opened, until dismissed. */
  readonly repairsOpen = signal(false);
  #abort: AbortController | null = null;

  constructor(services: Services, commands: CraftCommands<D>) {
    this.services = services;
    this.commands = commands;
  }

  /** The operation that a full solve runs, its input for the model, and what of its outputs is kept. */
  abstract readonly operationName: string;
  abstract readonly meshInputName: string;
  abstract readonly wantedOutputs: readonly string[];
  /** The parameters that the solve depends on, and the result made with them and the model in force. */
  abstract readonly asked: ReadonlySignal<JsonObject>;
  abstract readonly result: ReadonlySignal<CraftResult | null>;
  abstract readonly failedTitle: string;
  /** The request being solved in full; any change to it ends the solve. */
  solvingFor: Json = null;
  /** What a solve teaches about how long the next will take. */
  abstract measured(report: Report): Measured | null;
  abstract cancelPreview(): void;
  /** What a new model says of itself, and which parameters belonged to the old one. */
  protected abstract ownParameters(source: Source): JsonObject;
  protected abstract forgets(name: string): boolean;
  /** Brings what is shown up to date. */
  protected abstract follow(): void;

  // ---- models ----

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
        projects.do(
          this.commands.openModel(
            this.operation.value ?? operation,
            model,
            `Open ${name}`,
            this.ownParameters(model.source),
            (parameter) => this.forgets(parameter),
          ),
        );
        if (first) projects.do(nameProject(name.replace(/\.[^.]+$/, '')));
        this.repairsOpen.value = sentences(model.report, 'repairs').length > 0;
        return true;
      },
      ({ message }) => (this.problem.value = { kind: 'file', title: `Could not open ${name}`, message }),
    );
    return opened ?? false;
  }

  /** Runs one task that the strip shows and Esc cancels. Null when it failed, of which `failed` is told, or
   *  was cancelled. */
  async busy<T>(
    kind: 'opening' | 'solving' | 'exporting',
    name: string,
    task: (options: BusyOptions) => Promise<T>,
    failed: (error: JobError) => void,
  ): Promise<T | null> {
    this.cancel();
    const abort = (this.#abort = new AbortController());
    this.problem.value = null;
    this.activity.value = { kind, name, progress: null };
    const onProgress = (progress: Progress) => {
      if (this.#abort === abort) this.activity.value = { kind, name, progress };
    };
    try {
      return await task({ signal: abort.signal, onProgress });
    } catch (thrown) {
      const error = asJobError(thrown);
      if (error.code !== 'cancelled') failed(error);
      return null;
    } finally {
      if (this.#abort === abort) {
        this.#abort = null;
        this.activity.value = { kind: 'idle' };
        this.follow();
      }
    }
  }

  cancel(): void {
    this.#abort?.abort();
  }

  /** Ends a full solve of what is no longer asked for. */
  protected cancelOutdatedSolve(): void {
    const { model } = this.document.value;
    const solving = untracked(() => this.activity.value.kind === 'solving');
    if (model === null || !solving || this.result.value !== null || this.solvingFor === null) return;
    if (!jsonEqual(this.solvingFor, requestKey(model.mesh.blob, this.asked.value))) this.cancel();
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

  // ---- parameters ----

  preview(name: string, value: Json): void {
    const operation = this.operation.value;
    if (operation === null) return;
    const title = operation.parameters.properties[name]?.title ?? name;
    this.services.projects.do(
      this.commands.setParameters(operation, { [name]: value }, `Change ${title.toLowerCase()}`, name),
    );
  }

  /** Several at once, as one step; `coalesce` names what is being dragged. */
  setParameters(values: JsonObject, label: string, coalesce?: string): void {
    const operation = this.operation.value;
    if (operation === null) return;
    const known = Object.fromEntries(
      Object.entries(values).filter(([name]) => name in operation.parameters.properties),
    );
    this.services.projects.do(this.commands.setParameters(operation, known, label, coalesce));
    if (coalesce === undefined) this.services.projects.commit();
  }

  value(name: string): Json {
    const operation = this.operation.value;
    return operation === null ? null : inForce(operation, this.document.value.parameters, name);
  }

  /** An error that names a parameter goes to its field, any other into a note. */
  report(error: JobError, title: string): void {
    if (error.where !== '' && this.operation.value?.parameters.properties[error.where])
      this.fieldErrors.value = { [error.where]: error.message };
    else this.problem.value = { kind: 'solve', title, message: error.message };
  }

  // ---- what is kept ----

  async keepPicture(resultId: string, picture: Blob): Promise<void> {
    const reference = await this.keep(new Uint8Array(await picture.arrayBuffer()), picture.type);
    const amend = (old: CraftResult) => ({ ...old, picture: reference });
    this.services.projects.do(this.commands.amendResult(resultId, amend));
  }

  keep(bytes: Uint8Array<ArrayBuffer>, media_type: string): Promise<BlobReference> {
    return keepBytes(this.services.projects.blobs, bytes, media_type);
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
