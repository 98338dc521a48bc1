// SPDX-License-Identifier: GPL-3.0-or-later
// What the relief page does beyond opening models: keeps the preview up to date, shows what was solved.
import { computed, effect, signal, untracked } from '@preact/signals';
import type { JsonObject, Operation, Report } from '../../jobs/contract';
import { asJobError, findOperation } from '../../jobs/contract';
import { LatestOnly } from '../../jobs/latest_only';
import { readPly } from '../../jobs/mesh_reader';
import type { BlobReference } from '../../project/document';
import { jsonEqual } from '../../project/document';
import type { CraftResult, Source } from '../common/craft_document';
import { meshInput } from '../common/craft_document';
import { CraftSession } from '../common/craft_session';
import type { Measured } from '../common/estimate';
import { estimateMemory_mb, estimateSeconds, recall } from '../common/estimate';
import { bytesOf } from '../common/import_model';
import { readMesh } from '../common/read_mesh';
import { figure } from '../common/report';
import type { Services } from '../common/services';
import type { ShadedMesh } from '../common/shaded_mesh';
import { currentResult, relief } from './relief_document';
import { solverSeconds } from './report';

export interface Shown {
  readonly kind: 'preview' | 'full';
  readonly mesh: ShadedMesh;
  readonly report: Report;
  readonly parameters: JsonObject;
  /** The mesh it was made from; equal names have equal triangles. */
  readonly from: string;
}

export class ReliefSession extends CraftSession {
  readonly operationName = 'relief';
  readonly meshInputName = 'mesh';
  /** The worker keeps the others until they are asked for. */
  readonly wantedOutputs = ['relief.ply', 'relief.stl'];
  readonly failedTitle = 'Could not solve the relief';
  readonly document = computed(() => relief.of(this.services.projects.document.value));
  readonly operation = computed<Operation | null>(() => {
    const catalog = this.services.catalog.value;
    return catalog === null ? null : (findOperation(catalog, this.operationName) ?? null);
  });
  readonly asked = computed(() => this.document.value.parameters);
  readonly result = computed(() => currentResult(this.document.value));
  readonly shown = signal<Shown | null>(null);
  readonly previewing = signal(false);
  readonly previewSeconds = signal<number | null>(null);
  readonly #previewed = signal<Measured | null>(null);
  readonly #previewMemory_mb = signal(0);
  readonly #preview: LatestOnly<PreviewRequest>;

  constructor(services: Services) {
    super(services, relief);
    this.#preview = new LatestOnly(
      (request, abort) => this.#runPreview(request, abort),
      (running, next) => running.mesh.blob !== next.mesh.blob,
      (running, next) =>
        running.mesh.blob === next.mesh.blob && jsonEqual(running.parameters, next.parameters),
    );
    effect(() => {
      const from = this.document.value.model?.mesh.blob ?? null;
      if (from === null) this.shown.value = null;
      if (this.active.value) void this.loadOriginal(from);
    });
    effect(() => this.follow());
  }

  /** A new model starts with its own viewpoint; sizes stay as the maker set them. */
  protected forgets(name: string): boolean {
    return this.operation.value?.parameters.properties[name]?.['x-group'] === 'Viewpoint';
  }

  /** Our own samples say from where they are best seen. */
  protected ownParameters(source: Source): JsonObject {
    const samples = this.services.catalog.value?.samples ?? [];
    const sample = source.kind === 'sample' ? samples.find(({ name }) => name === source.sample) : undefined;
    return {
      ...(sample?.view_direction ? { direction: sample.view_direction } : {}),
      ...(sample?.view_up ? { up: sample.view_up } : {}),
    };
  }

  setViewpoint(values: JsonObject, coalesce?: string): void {
    this.setParameters(values, 'Set the viewpoint', coalesce);
  }

  cancelPreview(): void {
    this.#preview.cancel();
  }

  /** Whenever model or parameters change: show the full result made with them, or preview. */
  protected follow(): void {
    const { model, parameters } = this.document.value;
    if (!this.active.value || model === null || this.operation.value === null) return;
    const { result } = this;
    const found = result.value;
    this.cancelOutdatedSolve();
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

  async #showResult(result: CraftResult): Promise<void> {
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
      const job = { operation: this.operationName, parameters, inputs, outputs: ['relief.ply'] };
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
    const measured = this.measured(report);
    if (measured === null) return;
    this.#previewed.value = measured;
    this.#previewMemory_mb.value = this.services.browser.memory_mb ?? 0;
  }

  measured(report: Report): Measured | null {
    const seconds = solverSeconds(report);
    const vertices = figure(report, 'vertices');
    return seconds && vertices && report['factor_reused'] !== true ? { vertices, seconds } : null;
  }

  /** Seconds and memory a full solve may take; null where nothing is known yet. */
  readonly estimate = computed(() => {
    const vertices = figure(this.document.value.model?.report ?? {}, 'vertices');
    const preview = this.#previewed.value;
    if (vertices === null) return null;
    const worker = recall('relief', 'native');
    const browser = recall('relief', 'wasm') ?? preview;
    return {
      browser_s: browser ? estimateSeconds(browser, vertices) : null,
      worker_s: worker ? estimateSeconds(worker, vertices) : null,
      memory_mb: preview ? estimateMemory_mb(this.#previewMemory_mb.value, preview.vertices, vertices) : null,
    };
  });
}

interface PreviewRequest {
  readonly mesh: BlobReference;
  readonly parameters: JsonObject;
}
