// SPDX-License-Identifier: GPL-3.0-or-later
// What the relief page does: opens models, keeps the preview up to date, solves in full, makes files. It
// holds no state that matters; that is in the project document.
import { computed, effect, signal, untracked } from '@preact/signals';
import type { Json, JsonObject, Operation, Progress, Report } from '../../jobs/contract';
import { asJobError, findOperation, JobError } from '../../jobs/contract';
import { LatestOnly } from '../../jobs/latest_only';
import { readPly } from '../../jobs/mesh_reader';
import type { BlobReference } from '../../project/document';
import { jsonEqual } from '../../project/document';
import type { Services } from '../common/services';
import type { Measured } from './estimate';
import { estimateMemory_mb, estimateSeconds, recall } from './estimate';
import type { ShadedMesh } from './meshes';
import { readMesh } from './read_mesh';
import { bytesOf, importModel, keep as keepBytes } from './import_model';
import type { ReliefResult, Source } from './relief_document';
import {
  amendResult,
  currentResult,
  inForce,
  meshInput,
  nameProject,
  openModel,
  reliefOf,
  requestKey,
  setParameters,
  titleOf,
} from './relief_document';
import { figure, sentences, solverSeconds } from './report';

export interface Shown {
  readonly kind: 'preview' | 'full';
  readonly mesh: ShadedMesh;
  readonly report: Report;
  readonly parameters: JsonObject;
  /** The mesh it was made from; equal names have equal triangles. */
  readonly from: string;
}

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

export class ReliefSession {
  readonly services: Services;
  readonly document = computed(() => reliefOf(this.services.projects.document.value));
  readonly operation = computed<Operation | null>(() => {
    const catalog = this.services.catalog.value;
    return catalog === null ? null : (findOperation(catalog, 'relief') ?? null);
  });
  readonly result = computed(() => currentResult(this.document.value));
  readonly original = signal<{ readonly mesh: ShadedMesh; readonly from: string } | null>(null);
  readonly shown = signal<Shown | null>(null);
  readonly activity = signal<Activity>({ kind: 'idle' });
  readonly previewing = signal(false);
  readonly previewSeconds = signal<number | null>(null);
  readonly problem = signal<Problem | null>(null);
  readonly fieldErrors = signal<Readonly<Record<string, string>>>({});
  /** Repairs of the model just opened, until dismissed. */
  readonly repairsOpen = signal(false);
  readonly #measured = signal<Measured | null>(null);
  readonly #previewMemory_mb = signal(0);
  readonly #preview: LatestOnly<PreviewRequest>;
  #abort: AbortController | null = null;
  /** The request being solved in full; any change to it ends the solve. */
  solvingFor: Json = null;

  constructor(services: Services) {
    this.services = services;
    this.#preview = new LatestOnly(
      (request, abort) => this.#runPreview(request, abort),
      (running, next) => running.mesh.blob !== next.mesh.blob,
      (running, next) =>
        running.mesh.blob === next.mesh.blob && jsonEqual(running.parameters, next.parameters),
    );
    effect(() => void this.#loadOriginal(this.document.value.model?.mesh.blob ?? null));
    effect(() => this.#follow());
  }

  // ---- models ----

  async openFile(file: File): Promise<boolean> {
    return await this.#open(file.name, async () => {
      const bytes = new Uint8Array(await file.arrayBuffer());
      const reference = await this.keep(bytes, file.type || 'application/octet-stream');
      return { kind: 'file', file_name: file.name, file: reference };
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
        const model = await importModel(browser, projects.blobs, await getSource(), options);
        const first = projects.isBlank.value && projects.document.value.name === 'New project';
        projects.do(openModel(operation, model, `Open ${name}`, this.#viewpointFor(model.source)));
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
        this.#follow();
      }
    }
  }

  cancel(): void {
    this.#abort?.abort();
  }

  cancelPreview(): void {
    this.#preview.cancel();
  }

  async #loadOriginal(from: string | null): Promise<void> {
    if (from === null) {
      this.original.value = null;
      this.shown.value = null;
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

  // ---- parameters and previews ----

  preview(name: string, value: Json): void {
    const operation = this.operation.value;
    if (operation === null) return;
    const title = operation.parameters.properties[name]?.title ?? name;
    this.services.projects.do(
      setParameters(operation, { [name]: value }, `Change ${title.toLowerCase()}`, name),
    );
  }

  setViewpoint(values: JsonObject, coalesce?: string): void {
    const operation = this.operation.value;
    if (operation === null) return;
    const known = Object.fromEntries(
      Object.entries(values).filter(([name]) => name in operation.parameters.properties),
    );
    this.services.projects.do(setParameters(operation, known, 'Set the viewpoint', coalesce));
    if (coalesce === undefined) this.services.projects.commit();
  }

  value(name: string): Json {
    const operation = this.operation.value;
    return operation === null ? null : inForce(operation, this.document.value.parameters, name);
  }

  /** Whenever model or parameters change: show the full result made with them, or preview. */
  #follow(): void {
    const { model, parameters } = this.document.value;
    if (model === null || this.operation.value === null) return;
    const { result } = this;
    const found = result.value;
    const solving = untracked(() => this.activity.value.kind === 'solving');
    if (
      solving &&
      found === null &&
      this.solvingFor !== null &&
      !jsonEqual(this.solvingFor, requestKey(model.mesh.blob, parameters))
    )
      this.cancel();
    const shown = untracked(() => this.shown.value);
    if (found?.outputs['relief.ply']) void untracked(() => this.#showResult(found));
    else if (
      shown === null ||
      shown.kind === 'full' ||
      shown.from !== model.preview.blob ||
      !jsonEqual(shown.parameters, parameters)
    )
      untracked(() => this.#preview.request({ mesh: model.preview, parameters }));
  }

  async #showResult(result: ReliefResult): Promise<void> {
    const ply = result.outputs['relief.ply'];
    const shown = untracked(() => this.shown.value);
    if (ply === undefined) return;
    if (
      shown?.kind === 'full' &&
      shown.from === result.mesh &&
      jsonEqual(shown.parameters, result.parameters)
    )
      return;
    this.#preview.cancel();
    try {
      const mesh = await readMesh(await this.services.projects.blobs.read(ply.blob));
      if (this.result.value?.id !== result.id) return;
      const { report, parameters } = result;
      this.fieldErrors.value = {};
      this.shown.value = { kind: 'full', mesh, report, parameters, from: result.mesh };
    } catch {
      // Its bytes were not kept; a preview stands in for it.
      const model = this.document.value.model;
      if (model) this.#preview.request({ mesh: model.preview, parameters: result.parameters });
    }
  }

  async #runPreview({ mesh, parameters }: PreviewRequest, abort: AbortSignal): Promise<void> {
    this.previewing.value = true;
    const start = performance.now();
    try {
      const inputs = { mesh: meshInput(mesh, 'preview.ply') };
      const job = { operation: 'relief', parameters, inputs, outputs: ['relief.ply'] };
      const done = await this.services.browser.run(job, { signal: abort });
      const ply = await readPly(await bytesOf(done, 'relief.ply'));
      this.previewSeconds.value = (performance.now() - start) / 1000;
      this.#measurePreview(done.report);
      if (this.document.value.model?.preview.blob !== mesh.blob || this.result.value !== null) return;
      this.fieldErrors.value = {};
      this.shown.value = { kind: 'preview', mesh: ply, report: done.report, parameters, from: mesh.blob };
    } catch (thrown) {
      const error = asJobError(thrown);
      if (error.code !== 'cancelled') this.report(error, 'Could not preview the relief');
    } finally {
      this.previewing.value = false;
    }
  }

  #measurePreview(report: Report): void {
    const seconds = solverSeconds(report);
    const vertices = figure(report, 'vertices');
    if (seconds === null || vertices === null || report['factor_reused'] === true) return;
    this.#measured.value = { vertices, seconds };
    this.#previewMemory_mb.value = this.services.browser.memory_mb ?? 0;
  }

  /** An error that names a parameter goes to its field, any other into a note. */
  report(error: JobError, title: string): void {
    if (error.where !== '' && this.operation.value?.parameters.properties[error.where])
      this.fieldErrors.value = { [error.where]: error.message };
    else this.problem.value = { kind: 'solve', title, message: error.message };
  }

  // ---- solving in full ----

  /** Seconds and memory a full solve may take; null where nothing is known yet. */
  readonly estimate = computed(() => {
    const vertices = figure(this.document.value.model?.report ?? {}, 'vertices');
    const preview = this.#measured.value;
    if (vertices === null) return null;
    const worker = recall('native');
    const browser = recall('wasm') ?? preview;
    return {
      browser_s: browser ? estimateSeconds(browser, vertices) : null,
      worker_s: worker ? estimateSeconds(worker, vertices) : null,
      memory_mb: preview ? estimateMemory_mb(this.#previewMemory_mb.value, preview.vertices, vertices) : null,
    };
  });

  async keepPicture(resultId: string, picture: Blob): Promise<void> {
    const reference = await this.keep(new Uint8Array(await picture.arrayBuffer()), picture.type);
    this.services.projects.do(amendResult(resultId, (old) => ({ ...old, picture: reference })));
  }

  keep(bytes: Uint8Array<ArrayBuffer>, media_type: string): Promise<BlobReference> {
    return keepBytes(this.services.projects.blobs, bytes, media_type);
  }

  /** Our own samples say from where they are best seen. */
  #viewpointFor(source: Source): JsonObject {
    const samples = this.services.catalog.value?.samples ?? [];
    const sample = source.kind === 'sample' ? samples.find(({ name }) => name === source.sample) : undefined;
    return {
      ...(sample?.view_direction ? { direction: sample.view_direction } : {}),
      ...(sample?.view_up ? { up: sample.view_up } : {}),
    };
  }

  async #needOperation(): Promise<Operation> {
    const operation = findOperation(
      this.services.catalog.value ?? (await this.services.browser.catalog()),
      'relief',
    );
    if (operation === undefined)
      throw new JobError({ code: 'internal', where: '', message: 'This build cannot make reliefs.' });
    return operation;
  }

  get title(): string {
    const model = this.document.value.model;
    return model === null ? 'relief' : titleOf(model.source).replace(/\.[^.]+$/, '');
  }
}

interface PreviewRequest {
  readonly mesh: BlobReference;
  readonly parameters: JsonObject;
}
