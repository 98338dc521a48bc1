// SPDX-License-Identifier: GPL-3.0-or-later
// What the relief page does beyond opening models: keeps the preview up to date, shows what was solved.
import { computed, signal } from '@preact/signals';
import type { JsonObject, Operation, Report } from '../../jobs/contract';
import { findOperation } from '../../jobs/contract';
import { readPly } from '../../jobs/mesh_reader';
import type { CraftDocument, CraftResult, Source } from '../../shared/session/craft_document';
import type { Measured } from '../../shared/session/estimate';
import { estimateMemory_mb, expectedTimes } from '../../shared/session/estimate';
import { bytesOf } from '../../shared/session/import_model';
import { OpenedModel } from '../../shared/session/opened_model';
import type { PreviewRequest, ShownWork } from '../../shared/session/previews';
import { Previews } from '../../shared/session/previews';
import { readMesh } from '../../shared/session/read_mesh';
import { figure } from '../../shared/session/report';
import { RoomSession } from '../../shared/session/room_session';
import type { Services } from '../../shared/session/services';
import type { ShadedMesh } from '../../shared/panels/shaded_mesh';
import type { Viewpoint } from '../../view';
import { parametersOf } from './meshes';
import { currentResult, relief } from './relief_document';
import { solverSeconds } from './report';

export interface Shown extends ShownWork {
  readonly mesh: ShadedMesh;
}

const shownOutputs = ['relief.ply'];

export class ReliefSession extends RoomSession<CraftDocument> {
  readonly operationName = 'relief';
  /** The worker keeps the others until they are asked for. */
  readonly wantedOutputs = ['relief.ply', 'relief.stl'];
  readonly failedTitle = 'Could not solve the relief';
  readonly document = computed(() => relief.of(this.services.projects.document.value));
  readonly operation = computed<Operation | null>(() => {
    const catalog = this.services.catalog.value;
    return catalog === null ? null : (findOperation(catalog, this.operationName) ?? null);
  });
  readonly asked = computed(() => this.document.value.parameters);
  readonly model: OpenedModel<CraftDocument> = new OpenedModel(this, {
    commands: relief,
    inputName: 'mesh',
    ownParameters: (source) => this.#viewpointOf(source),
    // A new model starts with its own viewpoint; sizes stay as the maker set them.
    forgets: (name) => this.operation.value?.parameters.properties[name]?.['x-group'] === 'Viewpoint',
  });
  readonly hasWork = this.model.isThere;
  readonly subject = this.model.subject;
  readonly result = this.unlessLost(computed(() => currentResult(this.document.value)));
  readonly previews = new Previews<CraftDocument, Shown>(this, {
    shownOutputs,
    failedTitle: 'Could not preview the relief',
    make: (request, signal) => this.#makePreview(request, signal),
    read: (result) => this.#readResult(result),
  });
  readonly shown = this.previews.shown;
  readonly #previewed = signal<Measured | null>(null);
  readonly #previewMemory_mb = signal(0);

  constructor(services: Services) {
    super(services, relief);
    this.previews.startFollowing();
  }

  openFiles(files: readonly File[]): Promise<boolean> {
    return this.model.openFiles(files);
  }

  get title(): string {
    return this.model.title;
  }

  cancelPreview(): void {
    this.previews.cancel();
  }

  protected follow(): void {
    this.previews.follow();
  }

  /** Our own samples say from where they are best seen. */
  #viewpointOf(source: Source): JsonObject {
    const samples = this.services.catalog.value?.samples ?? [];
    const sample = source.kind === 'sample' ? samples.find(({ name }) => name === source.sample) : undefined;
    return {
      ...(sample?.view_direction ? { direction: sample.view_direction } : {}),
      ...(sample?.view_up ? { up: sample.view_up } : {}),
    };
  }

  /** What is shown was made of the model that is open. */
  readonly fits = computed(() => {
    const { model } = this.document.value;
    const from = this.shown.value?.from;
    return from !== undefined && (from === model?.mesh.blob || from === model?.preview.blob);
  });

  /** Millimetres a unit of the model, as it is drawn beside its relief. */
  readonly drawnScale = computed(() => {
    const positions = this.model.original.value?.mesh.positions;
    const reported = this.fits.value ? figure(this.shown.value?.report ?? {}, 'scale_mm_per_unit') : null;
    return reported ?? (positions ? provisionalScale(positions, Number(this.value('width_mm') ?? 100)) : 1);
  });

  /** The relief is to be made for what this camera sees; `coalesce` while it moves. */
  setViewpoint(camera: Viewpoint, coalesce?: string): void {
    const positions = this.model.original.peek()?.mesh.positions;
    if (positions === undefined) return;
    const values = parametersOf(camera, positions, this.drawnScale.peek());
    this.setParameters(values, 'Set the viewpoint', coalesce);
  }

  async #readResult({ outputs, report, parameters, mesh }: CraftResult): Promise<Shown> {
    const bytes = await this.services.projects.blobs.read(outputs['relief.ply']?.blob ?? '');
    return { kind: 'full', mesh: await readMesh(bytes), report, parameters, from: mesh };
  }

  async #makePreview({ subject, parameters }: PreviewRequest, signal: AbortSignal): Promise<Shown> {
    const { inputs } = subject;
    const job = { operation: this.operationName, parameters, inputs, outputs: shownOutputs };
    const { report, outputs } = await this.services.browser.run(job, { signal });
    const relief = await readPly(await bytesOf({ report, outputs }, 'relief.ply'));
    this.#measurePreview(report);
    return { kind: 'preview', mesh: relief, report, parameters, from: subject.key };
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
    return {
      ...expectedTimes('relief', vertices, preview),
      memory_mb: preview ? estimateMemory_mb(this.#previewMemory_mb.value, preview.vertices, vertices) : null,
    };
  });
}

/** Until the first relief says the scale: the model's x extent as the width. */
function provisionalScale(positions: Float32Array, width_mm: number): number {
  let [low, high] = [Infinity, -Infinity];
  for (let i = 0; i < positions.length; i += 3) {
    low = Math.min(low, positions[i] ?? 0);
    high = Math.max(high, positions[i] ?? 0);
  }
  return high > low ? width_mm / (high - low) : 1;
}
