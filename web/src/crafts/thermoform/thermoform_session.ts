// SPDX-License-Identifier: GPL-3.0-or-later
// What the thermoforming page does beyond opening models: forms a coarse sheet at every change, shows what was
// formed in full, keeps the moment of the film that is looked at.
import { computed, effect, signal, untracked } from '@preact/signals';
import type { JsonObject, Operation, Report } from '../../jobs/contract';
import { asJobError, findOperation } from '../../jobs/contract';
import type { Film } from '../../jobs/glb';
import { LatestOnly } from '../../jobs/latest_only';
import { readFilm, readPly } from '../../jobs/mesh_reader';
import type { PlyMesh } from '../../jobs/ply';
import type { BlobReference } from '../../project/document';
import { jsonEqual } from '../../project/document';
import type { CraftResult } from '../common/craft_document';
import { inForce, meshInput } from '../common/craft_document';
import { CraftSession } from '../common/craft_session';
import type { Measured } from '../common/estimate';
import { estimateSeconds, recall } from '../common/estimate';
import { bytesOf } from '../common/import_model';
import { figure } from '../common/report';
import type { Services } from '../common/services';
import { endOf, momentAt, phaseAt, phasesOf } from './film';
import {
  formedSheet,
  known,
  moulding,
  offered,
  printing,
  productOf,
  simulate,
  thermoform,
} from './thermoform_document';
import type { ThermoformDocument } from './thermoform_document';

export interface Formed {
  readonly kind: 'preview' | 'full';
  readonly sheet: PlyMesh;
  readonly film: Film;
  readonly report: Report;
  /** Of the simulation; what is not here has its default. */
  readonly parameters: JsonObject;
  /** The mesh it was formed over. */
  readonly from: string;
}

/** Coarse enough to re-form while the model is dragged. */
const previewTriangles = 2500;
/** A preview that has run longer than this is given up for a newer one. */
const patience_ms = 1500;

export class ThermoformSession extends CraftSession<ThermoformDocument> {
  readonly operationName = simulate;
  readonly meshInputName = 'mould';
  readonly wantedOutputs = ['sheet.ply', 'forming.glb'];
  readonly failedTitle = 'Could not form the sheet';
  readonly document = computed(() => thermoform.of(this.services.projects.document.value));
  readonly operation = computed<Operation | null>(() => {
    const catalog = this.services.catalog.value;
    return catalog && offered(catalog);
  });
  readonly asked = computed(() => known(this.operationNamed(simulate), this.document.value.parameters));
  readonly result = computed(() => formedSheet(this.document.value, this.asked.value));
  readonly print = computed(() => productOf(this.document.value, this.operationNamed(printing)));
  readonly mould = computed(() => productOf(this.document.value, this.operationNamed(moulding)));
  readonly shown = signal<Formed | null>(null);
  readonly previewing = signal(false);
  readonly previewSeconds = signal<number | null>(null);
  /** Of the film, seconds from the start; its end is what the sheet is like when it has cooled. */
  readonly time_s = signal(0);
  readonly moment = computed(() => {
    const film = this.shown.value?.film;
    const phase = phaseAt(this.phases.value, this.time_s.value);
    return film ? { ...momentAt(film, this.time_s.value), phase } : null;
  });
  readonly phases = computed(() => {
    const shown = this.shown.value;
    if (shown === null) return [];
    const { film, report } = shown;
    return phasesOf(film, {
      relax: figure(report, 'relaxation_end_s'),
      raise: figure(report, 'raise_end_s'),
    });
  });
  readonly #previewed = signal<Measured | null>(null);
  readonly #preview: LatestOnly<PreviewRequest>;
  #previewStart = 0;

  constructor(services: Services) {
    super(services, thermoform);
    this.#preview = new LatestOnly(
      (request, abort) => this.#runPreview(request, abort),
      (running, next) =>
        running.mesh.blob !== next.mesh.blob || performance.now() - this.#previewStart > patience_ms,
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

  operationNamed(name: string): Operation | undefined {
    const catalog = this.services.catalog.value;
    return catalog ? findOperation(catalog, name) : undefined;
  }

  /** Size and place belonged to the old model; sheet and machine are still the same. */
  protected forgets(name: string): boolean {
    return this.operation.value?.parameters.properties[name]?.['x-group'] === 'Placement';
  }

  protected ownParameters(): JsonObject {
    return {};
  }

  /** With defaults filled in. */
  filled(parameters: JsonObject): JsonObject {
    const operation = this.operationNamed(simulate);
    if (operation === undefined) return parameters;
    const names = Object.keys(operation.parameters.properties);
    return Object.fromEntries(names.map((name) => [name, inForce(operation, parameters, name)]));
  }

  cancelPreview(): void {
    this.#preview.cancel();
  }

  /** Whenever model or parameters change: show the sheet formed with them, or form a coarse one. */
  protected follow(): void {
    const { model } = this.document.value;
    const parameters = this.asked.value;
    if (!this.active.value || model === null || this.operation.value === null) return;
    const found = this.result.value;
    this.cancelOutdatedSolve();
    const shown = untracked(() => this.shown.value);
    if (found?.outputs['sheet.ply'] && found.outputs['forming.glb'])
      void untracked(() => this.#showResult(found));
    else if (
      shown === null ||
      shown.kind === 'full' ||
      shown.from !== model.preview.blob ||
      !jsonEqual(shown.parameters, parameters)
    )
      untracked(() => this.#preview.request({ mesh: model.preview, parameters }));
  }

  async #showResult(result: CraftResult): Promise<void> {
    const { 'sheet.ply': ply, 'forming.glb': glb } = result.outputs;
    const shown = untracked(() => this.shown.value);
    if (ply === undefined || glb === undefined) return;
    if (
      shown?.kind === 'full' &&
      shown.from === result.mesh &&
      jsonEqual(shown.parameters, result.parameters)
    )
      return;
    this.#preview.cancel();
    try {
      const { blobs } = this.services.projects;
      const sheet = await readPly(await blobs.read(ply.blob));
      const film = await readFilm(await blobs.read(glb.blob));
      if (this.result.value?.id !== result.id) return;
      const { report, parameters, mesh } = result;
      this.#show({ kind: 'full', sheet, film, report, parameters, from: mesh });
    } catch {
      // Its bytes were not kept; a coarse sheet stands in for it.
      const model = this.document.value.model;
      if (model) this.#preview.request({ mesh: model.preview, parameters: result.parameters });
    }
  }

  /** Keeps the moment looked at; who looked at the end goes on doing so. */
  #show(formed: Formed): void {
    const before = this.shown.value?.film;
    const atEnd = before === undefined || this.time_s.value >= endOf(before) - 1e-6;
    this.fieldErrors.value = {};
    this.shown.value = formed;
    const end = endOf(formed.film);
    this.time_s.value = atEnd ? end : Math.min(this.time_s.value, end);
  }

  async #runPreview({ mesh, parameters }: PreviewRequest, abort: AbortSignal): Promise<void> {
    this.previewing.value = true;
    const start = (this.#previewStart = performance.now());
    try {
      const triangles = Math.min(previewTriangles, Number(this.filled(parameters)['triangles'] ?? Infinity));
      const job = {
        operation: simulate,
        parameters: { ...parameters, triangles },
        inputs: { mould: meshInput(mesh, 'preview.ply') },
        outputs: this.wantedOutputs,
      };
      const done = await this.services.browser.run(job, { signal: abort });
      const sheet = await readPly(await bytesOf(done, 'sheet.ply'));
      const film = await readFilm(await bytesOf(done, 'forming.glb'));
      this.previewSeconds.value = (performance.now() - start) / 1000;
      this.#previewed.value = this.measured(done.report) ?? this.#previewed.value;
      if (this.document.value.model?.preview.blob !== mesh.blob || this.result.value !== null) return;
      this.#show({ kind: 'preview', sheet, film, report: done.report, parameters, from: mesh.blob });
    } catch (thrown) {
      const error = asJobError(thrown);
      if (error.code !== 'cancelled') this.report(error, 'Could not preview the forming');
    } finally {
      this.previewing.value = false;
    }
  }

  /** The sheet's vertices are what a simulation's time grows with. */
  measured(report: Report): Measured | null {
    const seconds = figure(report, 'seconds_simulation');
    const vertices = figure(report, 'vertices');
    return seconds && vertices && report['reused'] !== true ? { vertices, seconds } : null;
  }

  /** Seconds that forming in full may take; null where nothing is known yet. */
  readonly estimate = computed(() => {
    const vertices = Number(this.value('triangles') ?? 0) / 2;
    const [worker, browser] = [
      recall('thermoform', 'native'),
      recall('thermoform', 'wasm') ?? this.#previewed.value,
    ];
    return {
      browser_s: browser ? estimateSeconds(browser, vertices) : null,
      worker_s: worker ? estimateSeconds(worker, vertices) : null,
    };
  });
}

interface PreviewRequest {
  readonly mesh: BlobReference;
  readonly parameters: JsonObject;
}
