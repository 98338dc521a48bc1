// SPDX-License-Identifier: GPL-3.0-or-later
// What every room does: it runs one task at a time that the strip shows and Esc cancels, says what went wrong,
// changes parameters. It holds no state that matters; that is in the project document.
import type { ReadonlySignal } from '@preact/signals';
import { signal, untracked } from '@preact/signals';
import type { JobError, Json, JsonObject, Operation, Progress, Report } from '../../jobs/contract';
import { asJobError } from '../../jobs/contract';
import type { BlobReference } from '../../project/document';
import { jsonEqual } from '../../project/document';
import type { CraftResult, RoomCommands, RoomDocument, Subject } from './craft_document';
import { inForce, requestKey } from './craft_document';
import type { Measured } from './estimate';
import { keep as keepBytes } from './import_model';
import type { Services } from './services';

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

export abstract class RoomSession<D extends RoomDocument = RoomDocument> {
  readonly services: Services;
  readonly commands: RoomCommands<D>;
  abstract readonly document: ReadonlySignal<D>;
  /** All parameters that the page offers. */
  abstract readonly operation: ReadonlySignal<Operation | null>;
  /** Something has been opened here. */
  abstract readonly hasWork: ReadonlySignal<boolean>;
  /** Its page is looked at: only then is anything kept up to date. */
  readonly active = signal(false);
  readonly activity = signal<Activity>({ kind: 'idle' });
  readonly problem = signal<Problem | null>(null);
  readonly fieldErrors = signal<Readonly<Record<string, string>>>({});
  #abort: AbortController | null = null;

  constructor(services: Services, commands: RoomCommands<D>) {
    this.services = services;
    this.commands = commands;
  }

  /** The operation that a full solve runs, what it is about, and what of its outputs is kept. */
  abstract readonly operationName: string;
  abstract readonly subject: ReadonlySignal<Subject | null>;
  abstract readonly wantedOutputs: readonly string[];
  /** The parameters that the solve depends on, and the result made with them and the subject in force. */
  abstract readonly asked: ReadonlySignal<JsonObject>;
  abstract readonly result: ReadonlySignal<CraftResult | null>;
  abstract readonly failedTitle: string;
  /** The request being solved in full; any change to it ends the solve. */
  solvingFor: Json = null;
  /** What a solve teaches about how long the next will take. */
  abstract measured(report: Report): Measured | null;
  abstract cancelPreview(): void;
  /** Takes up what was dropped or chosen. */
  abstract openFiles(files: readonly File[]): Promise<boolean>;
  /** What downloads are named after. */
  abstract get title(): string;
  /** Brings what is shown up to date. */
  protected abstract follow(): void;

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
    const subject = this.subject.value;
    const solving = untracked(() => this.activity.value.kind === 'solving');
    if (subject === null || !solving || this.result.value !== null || this.solvingFor === null) return;
    if (!jsonEqual(this.solvingFor, requestKey(subject.key, this.asked.value))) this.cancel();
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
}
