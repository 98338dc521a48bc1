// SPDX-License-Identifier: GPL-3.0-or-later
// What every room does: it runs one task at a time that the strip shows and Esc cancels, says what went wrong,
// changes parameters. It holds no state that matters; that is in the project document.
import type { ReadonlySignal } from '@preact/signals';
import { computed, effect, signal, untracked } from '@preact/signals';
import { leaving } from '../../jobs/backend';
import type { JobError, Json, JsonObject, Operation, Progress, Report } from '../../jobs/contract';
import { asJobError, cancelled } from '../../jobs/contract';
import type { BlobReference, ProjectDocument } from '../../project/document';
import { jsonEqual } from '../../project/document';
import type { Command } from '../../project/history';
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

export type Change = (command: Command<ProjectDocument>) => void;

export interface BusyOptions {
  readonly signal: AbortSignal;
  readonly onProgress: (progress: Progress) => void;
  /** Changes the project that the task was begun in; throws `cancelled` where another one is open by now, or the task was ended. */
  readonly do: Change;
}

interface Task {
  readonly kind: Exclude<Activity['kind'], 'idle'>;
  readonly abort: AbortController;
  /** The project it was begun in. */
  readonly home: string;
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
  #task: Task | null = null;
  readonly #lost = signal<ReadonlySet<string>>(new Set());

  constructor(services: Services, commands: RoomCommands<D>) {
    this.services = services;
    this.commands = commands;
    // The first effect that a session has: all others that follow the document find that what ran before has been left.
    effect(() => {
      void services.projects.document.value;
      untracked(() => this.#leaveOtherProject());
    });
  }

  /** The operation that a full solve runs, what it is about, and what of its outputs is kept. */
  abstract readonly operationName: string;
  abstract readonly subject: ReadonlySignal<Subject | null>;
  abstract readonly wantedOutputs: readonly string[];
  /** The parameters that the solve depends on, and the result made with them and the subject in force: null where its bytes are lost. */
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
    kind: Task['kind'],
    name: string,
    task: (options: BusyOptions) => Promise<T>,
    failed: (error: JobError) => void,
  ): Promise<T | null> {
    this.cancel();
    const { projects } = this.services;
    const own: Task = { kind, abort: new AbortController(), home: projects.document.peek().id };
    const { signal } = own.abort;
    this.#task = own;
    this.problem.value = null;
    this.activity.value = { kind, name, progress: null };
    const onProgress = (progress: Progress) => {
      if (this.#task === own) this.activity.value = { kind, name, progress };
    };
    const changeHome = this.changesHere();
    const change: Change = (command) => {
      if (signal.aborted) throw cancelled();
      changeHome(command);
    };
    try {
      return await task({ signal, onProgress, do: change });
    } catch (thrown) {
      const error = asJobError(thrown);
      if (error.code !== 'cancelled' && !signal.aborted) failed(error);
      return null;
    } finally {
      if (this.#task === own) {
        this.#task = null;
        this.activity.value = { kind: 'idle' };
        this.follow();
      }
    }
  }

  /** Changes the project that is open now, however late: throws `cancelled` where another one has been opened meanwhile. */
  changesHere(): Change {
    const { projects } = this.services;
    const home = projects.document.peek().id;
    return (command) => {
      if (projects.document.peek().id !== home) throw cancelled();
      projects.do(command);
    };
  }

  cancel(): void {
    this.#task?.abort.abort();
  }

  /** Another project was opened: what runs here was asked for in the one before, and its end must not be written into this one. A solve
   *  that the worker has goes on there, where the project it belongs to finds it; anything else ends. */
  #leaveOtherProject(): void {
    const task = this.#task;
    if (task === null || task.home === this.services.projects.document.peek().id) return;
    this.#task = null;
    this.activity.value = { kind: 'idle' };
    task.abort.abort(task.kind === 'solving' ? leaving : undefined);
  }

  /** Ends a full solve of what is no longer asked for. */
  cancelOutdatedSolve(): void {
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

  /** What a person asked for: said in the notes too, since its field may be out of sight, and the preview that
   *  follows takes away what stands at the field. */
  reportAsked(error: JobError, title: string): void {
    this.report(error, title);
    this.problem.value = { kind: 'solve', title, message: error.message };
  }

  // ---- what is kept ----

  /** A result whose bytes cannot be read stays in the document, but counts as not made: it can only be made again. */
  lose({ id }: CraftResult): void {
    this.#lost.value = new Set([...this.#lost.peek(), id]);
  }

  /** Of a result that the document lists, what `result` is. */
  unlessLost(listed: ReadonlySignal<CraftResult | null>): ReadonlySignal<CraftResult | null> {
    return computed(() => {
      const found = listed.value;
      return found !== null && this.#lost.value.has(found.id) ? null : found;
    });
  }

  async keepPicture(resultId: string, picture: Blob): Promise<void> {
    const { projects } = this.services;
    const home = projects.document.peek().id;
    const reference = await this.keep(new Uint8Array(await picture.arrayBuffer()), picture.type);
    const amend = (old: CraftResult) => ({ ...old, picture: reference });
    // The command alone would make something of a blank project.
    if (projects.document.peek().id === home) projects.do(this.commands.amendResult(resultId, amend));
  }

  keep(bytes: Uint8Array<ArrayBuffer>, media_type: string): Promise<BlobReference> {
    return keepBytes(this.services.projects.blobs, bytes, media_type);
  }
}
