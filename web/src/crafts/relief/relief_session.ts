// SPDX-License-Identifier: GPL-3.0-or-later
// What the relief page does beyond opening models: keeps the preview up to date, shows what was solved.
import { computed, effect, signal, untracked } from '@preact/signals';
import type { JsonObject, Operation, Report } from '../../jobs/contract';
import { findOperation } from '../../jobs/contract';
import { readPly } from '../../jobs/mesh_reader';
import type { CraftResult, Source } from '../../shared/session/craft_document';
import type { Measured } from '../../shared/session/estimate';
import { estimateMemory_mb, expectedTimes } from '../../shared/session/estimate';
import { bytesOf } from '../../shared/session/import_model';
import { OpenedModel } from '../../shared/session/opened_model';
import type { PreviewRequest } from '../../shared/session/previews';
import { Previews } from '../../shared/session/previews';
import { readMesh } from '../../shared/session/read_mesh';
import { figure } from '../../shared/session/report';
import { RoomSession } from '../../shared/session/room_session';
import type { Services } from '../../shared/session/services';
import type { Viewpoint } from '../../view';
import { ForestSession } from './forest/forest_session';
import { ModelGroup } from './group/model_group';
import { ReliefLight } from './light/relief_light';
import { ReliefPieces } from './pieces/relief_pieces';
import { baseOf, parametersOf } from './meshes';
import { PaintSession } from './paint/paint_session';
import { paintingInputs } from './paint/painting';
import type { ReliefDocument, ReliefResult } from './relief_document';
import { baseInputs, currentResult, relief, sameMesh, takeBase } from './relief_document';
import { solverSeconds } from './report';
import type { Shown } from './shown';
import { SquashedRelief } from './squashed/squashed_relief';

const shownOutputs = ['relief.ply', 'base.ply'];

export class ReliefSession extends RoomSession<ReliefDocument> {
  readonly operationName = 'relief';
  /** The worker keeps the others until they are asked for. */
  readonly wantedOutputs = ['relief.ply', 'base.ply', 'relief.stl'];
  readonly failedTitle = 'Could not solve the relief';
  readonly document = computed(() => relief.of(this.services.projects.document.value));
  readonly operation = computed<Operation | null>(() => {
    const catalog = this.services.catalog.value;
    return catalog === null ? null : (findOperation(catalog, this.operationName) ?? null);
  });
  readonly asked = computed(() => this.document.value.parameters);
  readonly model: OpenedModel<ReliefDocument> = new OpenedModel(this, {
    commands: relief,
    inputName: 'mesh',
    ownParameters: (source) => this.#viewpointOf(source),
    // A new model starts with its own viewpoint; sizes stay as the maker set them.
    furtherInputs: computed(() => ({
      ...baseInputs(this.document.value),
      ...paintingInputs(this.document.value),
    })),
    forgets: (name) => this.operation.value?.parameters.properties[name]?.['x-group'] === 'Viewpoint',
  });
  /** Several models in one relief. */
  readonly group: ModelGroup;
  /** Several models on free-standing pillars: a view of this room with a document of its own. */
  readonly forest: ForestSession;
  readonly hasWork = computed(() => this.model.isThere.value || this.forest.open.value);
  readonly subject = this.model.subject;
  readonly result = this.unlessLost(computed(() => currentResult(this.document.value, this.subject.value)));
  readonly previews = new Previews<ReliefDocument, Shown>(this, {
    shownOutputs,
    failedTitle: 'Could not preview the relief',
    make: (request, signal) => this.#makePreview(request, signal),
    read: (result) => this.#readResult(result),
  });
  readonly shown = this.previews.shown;
  readonly light = new ReliefLight(this);
  readonly paint = new PaintSession(this);
  readonly pieces = new ReliefPieces(this);
  readonly squashed = new SquashedRelief(this);
  readonly #previewed = signal<Measured | null>(null);
  readonly #previewMemory_mb = signal(0);

  constructor(services: Services) {
    super(services, relief);
    this.forest = new ForestSession(services);
    this.group = new ModelGroup(this);
    effect(() => {
      this.forest.active.value = this.active.value && this.forest.open.value;
    });
    effect(() => {
      const found: ReliefResult | null = this.result.value;
      if (found === null || found.made_with !== undefined) return;
      untracked(() => this.services.projects.do(relief.noteInputs(found, this.document.value)));
    });
    this.previews.startFollowing();
    this.light.startFollowing();
    this.paint.startFollowing();
    this.pieces.startFollowing();
    this.squashed.startFollowing();
  }

  openFiles(files: readonly File[]): Promise<boolean> {
    return this.forest.open.value ? this.forest.openFiles(files) : this.#openModels(files);
  }

  /** Of several models dropped at once, the first is opened and the others are put beside it. */
  async #openModels(files: readonly File[]): Promise<boolean> {
    const models = this.model.modelsAmong(files);
    if (models.length < 2 || !this.group.available.value) return await this.model.openFiles(files);
    const [first, ...others] = models;
    const companions = files.filter((file) => !models.includes(file));
    if (first === undefined || !(await this.model.openFile({ model: first, companions }))) return false;
    for (const other of others) await this.group.addFile(other);
    return true;
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
    const from = this.shown.value?.from;
    const { subject, previewSubject } = this.model;
    return from !== undefined && (from === subject.value?.key || from === previewSubject.value?.key);
  });

  /** What is shown was made of the model that is open, with its painting and base or others. */
  readonly showsModel = computed(() => {
    const { subject, previewSubject } = this.model;
    const from = this.shown.value?.from;
    return from !== undefined && [subject, previewSubject].some(({ value }) => sameMesh(from, value?.key));
  });

  /** Millimetres a unit of the model, as it is drawn beside its relief. */
  readonly drawnScale = computed(() => {
    const positions = this.model.original.value?.mesh.positions;
    const reported = this.showsModel.value
      ? figure(this.shown.value?.report ?? {}, 'scale_mm_per_unit')
      : null;
    return reported ?? (positions ? provisionalScale(positions, Number(this.value('width_mm') ?? 100)) : 1);
  });

  /** The surface to work the relief into, from a file. */
  async openBase(file: File): Promise<void> {
    const kept = await this.keep(
      new Uint8Array(await file.arrayBuffer()),
      file.type || 'application/octet-stream',
    );
    this.changesHere()(takeBase({ file_name: file.name, file: kept }));
    this.services.projects.commit();
  }

  /** Back to the built-in shapes. */
  dropBase(): void {
    this.services.projects.do(takeBase(null));
    this.services.projects.commit();
  }

  /** The relief is to be made for what this camera sees; `coalesce` while it moves. */
  setViewpoint(camera: Viewpoint, coalesce?: string): void {
    const positions = this.model.original.peek()?.mesh.positions;
    if (positions === undefined) return;
    const values = parametersOf(camera, positions, this.drawnScale.peek());
    this.setParameters(values, 'Set the viewpoint', coalesce);
  }

  async #readResult({ outputs, report, parameters, mesh }: CraftResult): Promise<Shown> {
    const { blobs } = this.services.projects;
    const read = await readMesh(await blobs.read(outputs['relief.ply']?.blob ?? ''));
    const file = outputs['base.ply'];
    const base = file ? baseOf(await readPly(await blobs.read(file.blob))) : null;
    return { kind: 'full', mesh: read, base, report, parameters, from: mesh };
  }

  async #makePreview({ subject, parameters }: PreviewRequest, signal: AbortSignal): Promise<Shown> {
    const { inputs } = subject;
    const job = { operation: this.operationName, parameters, inputs, outputs: shownOutputs };
    const { report, outputs } = await this.services.browser.run(job, { signal });
    const relief = await readPly(await bytesOf({ report, outputs }, 'relief.ply'));
    const base = outputs.has('base.ply')
      ? baseOf(await readPly(await bytesOf({ report, outputs }, 'base.ply')))
      : null;
    this.#measurePreview(report);
    return { kind: 'preview', mesh: relief, base, report, parameters, from: subject.key };
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
