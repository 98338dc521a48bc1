// SPDX-License-Identifier: GPL-3.0-or-later
// What the zippable page does beyond opening models: designs a ribbon for a stand-in at every change, shows what was
// designed for the whole model.
import type { ReadonlySignal } from '@preact/signals';
import { computed, effect, signal, untracked } from '@preact/signals';
import type { Result } from '../../jobs/backend';
import type { JobInput, JsonObject, Operation, Report } from '../../jobs/contract';
import { findOperation } from '../../jobs/contract';
import type { Film } from '../../jobs/glb';
import { readFilm, readPolylines } from '../../jobs/mesh_reader';
import type { LaserSheet } from '../../machines/laser_sheet';
import type { CraftResult } from '../../shared/session/craft_document';
import { known } from '../../shared/session/craft_document';
import type { Measured } from '../../shared/session/estimate';
import { expectedTimes } from '../../shared/session/estimate';
import { bytesOf } from '../../shared/session/import_model';
import { OpenedModel } from '../../shared/session/opened_model';
import type { PreviewRequest, ShownWork } from '../../shared/session/previews';
import { Previews } from '../../shared/session/previews';
import type { Product } from '../../shared/session/products';
import { productOf } from '../../shared/session/products';
import { readMesh } from '../../shared/session/read_mesh';
import { figure } from '../../shared/session/report';
import { RoomSession } from '../../shared/session/room_session';
import type { Services } from '../../shared/session/services';
import type { ShadedMesh } from '../../shared/panels/shaded_mesh';
import { Bending } from './ribbon/bending';
import type { Design } from './design';
import { readDesign } from './design';
import type { RibbonPieces } from './ribbon/cut_ribbon';
import { cutByParts } from './ribbon/cut_ribbon';
import { PartBorders } from './ribbon/part_borders';
import type { PartDistortion } from './ribbon/part_map';
import { distortionOfParts, partsOfTriangles, VertexGrid } from './ribbon/part_map';
import { LaserSheets } from './laser_sheets';
import type { ZippableDocument } from './zippable_document';
import {
  currentResult,
  design,
  drawnOn,
  offered,
  planning,
  simulating,
  withoutErrors,
  zippable,
} from './zippable_document';

/** A model divided and parameterised; the same object for as many designs as are made on it. */
export interface DividedModel {
  readonly bytes: Uint8Array;
  readonly mesh: ShadedMesh;
  readonly grid: VertexGrid;
  /** Made when it is first asked for. */
  readonly borders: () => PartBorders;
  /** By part. */
  readonly distortion: readonly PartDistortion[];
}

export interface Zippable extends ShownWork {
  readonly design: Design;
  readonly model: DividedModel;
  /** The zipper's course on the model, a polyline a piece. */
  readonly course: readonly Float32Array[];
  /** By triangle of the ribbon. */
  readonly partOfTriangle: Int32Array;
  /** Cut along the parts' borders; made when it is first asked for. */
  readonly pieces: () => RibbonPieces;
  /** Made when it is first asked for. */
  readonly bending: () => Bending;
}

/** A slider that moves again within this was not at rest. */
const restMs = 400;

type Outputs = Pick<Result, 'outputs' | 'report'>;

/** Whole and previewed designs are shown by these. */
const shownOutputs = ['design.json', 'parameterised.ply', 'curve.obj'];

export class ZippableSession extends RoomSession<ZippableDocument> {
  readonly operationName = design;
  readonly wantedOutputs = ['design.json', 'parameterised.ply', 'curve.obj', 'ribbon.svg'];
  readonly failedTitle = 'Could not make the ribbon';
  readonly document = computed(() => zippable.of(this.services.projects.document.value));
  readonly operation = computed<Operation | null>(() => {
    const catalog = this.services.catalog.value;
    return catalog && offered(catalog);
  });
  readonly asked = computed(() => known(this.operationNamed(design), this.document.value.parameters));
  readonly #furtherInputs = computed((): Readonly<Record<string, JobInput>> => {
    const { segments } = drawnOn(this.document.value);
    return segments ? { segments: { sha256: segments.blob, file_name: 'segments.json' } } : {};
  });
  readonly model: OpenedModel<ZippableDocument> = new OpenedModel(this, {
    commands: zippable,
    inputName: 'mesh',
    furtherInputs: this.#furtherInputs,
    // The order was one of the old model's; widths and sizes stay as the maker set them.
    forgets: (name) => this.operation.value?.parameters.properties[name]?.['x-group'] === 'Zipper line',
  });
  readonly hasWork = this.model.isThere;
  readonly subject = this.model.subject;
  readonly result = this.unlessLost(
    computed(() => currentResult(this.document.value, this.subject.value, this.asked.value)),
  );
  readonly previews = new Previews<ZippableDocument, Zippable>(this, {
    shownOutputs,
    failedTitle: this.failedTitle,
    make: (request, signal) => this.#makePreview(request, signal),
    read: (result) => this.#readResult(result),
  });
  readonly shown = this.previews.shown;
  /** What plans are made of; null while the design is a preview. */
  readonly designFile = computed(() => this.result.value?.outputs['design.json'] ?? null);
  /** What a simulation takes: a plan has made up for errors of making. */
  readonly clothParameters = computed(() => {
    const operation = this.operationNamed(simulating);
    const { parameters } = this.document.value;
    return operation ? withoutErrors(operation, parameters) : parameters;
  });
  readonly plan = computed(() => this.#madeOfDesign(planning, this.sheets.parameters.value));
  readonly simulation = computed(() => this.#madeOfDesign(simulating, this.clothParameters.value));
  /** How the simulated cloth went, of the design in force. */
  readonly film = signal<Film | null>(null);
  /** The report of the previewed ribbon with its distances from the model; null until it rests. */
  readonly distances = signal<Report | null>(null);
  readonly #previewed = signal<Measured | null>(null);
  #divided: DividedModel | null = null;
  /** How large the sheets are that plans are laid out for. */
  readonly sheets: LaserSheets;

  constructor(services: Services, laser: ReadonlySignal<LaserSheet | null> = signal(null)) {
    super(services, zippable);
    this.sheets = new LaserSheets(this, laser);
    this.previews.startFollowing();
    this.#measureLater();
    this.#followSimulation();
    effect(() => {
      // What could not be made with other parameters or parts no longer matters.
      void this.asked.value;
      void this.#furtherInputs.value;
      untracked(() => {
        if (this.problem.value?.kind === 'solve') this.problem.value = null;
      });
    });
  }

  #madeOfDesign(operation: string, parameters: JsonObject): Product | null {
    const { value } = this.designFile;
    const { products } = this.document.value;
    return productOf({ products, parameters }, value?.blob ?? null, this.operationNamed(operation));
  }

  #followSimulation(): void {
    effect(() => {
      const file = this.simulation.value?.outputs['zipping.glb'];
      this.film.value = null;
      if (file === undefined || !this.active.value) return;
      const read = async () => {
        const film = await readFilm(await this.services.projects.blobs.read(file.blob));
        if (this.simulation.peek()?.outputs['zipping.glb'] === file) this.film.value = film;
      };
      read().catch(() => undefined); // its bytes were not kept; it can be made again
    });
  }

  operationNamed(name: string): Operation | undefined {
    const catalog = this.services.catalog.value;
    return catalog ? findOperation(catalog, name) : undefined;
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

  async #readResult({ outputs, report, parameters, mesh }: CraftResult): Promise<Zippable> {
    const { blobs } = this.services.projects;
    const read = (name: string) => blobs.read(outputs[name]?.blob ?? '');
    const shown = await this.#read(read, report);
    return { ...shown, kind: 'full', parameters, from: mesh };
  }

  async #makePreview({ subject, parameters }: PreviewRequest, signal: AbortSignal): Promise<Zippable> {
    const { inputs } = subject;
    const job = {
      operation: this.operationName,
      parameters: { ...parameters, measure_distances: false },
      inputs,
      outputs: shownOutputs,
    };
    const done: Outputs = await this.services.browser.run(job, { signal });
    this.#previewed.value = this.measured(done.report) ?? this.#previewed.value;
    const shown = await this.#read((name) => bytesOf(done, name), done.report);
    return { ...shown, kind: 'preview', parameters, from: subject.key };
  }

  async #read(
    bytes: (name: string) => Promise<Uint8Array<ArrayBuffer>>,
    report: Report,
  ): Promise<Omit<Zippable, 'kind' | 'parameters' | 'from'>> {
    const [json, ply, obj] = await Promise.all(shownOutputs.map(bytes));
    if (json === undefined || ply === undefined || obj === undefined)
      throw new Error('The design is incomplete.');
    const [model, course] = await Promise.all([this.#readModel(ply), readPolylines(obj)]);
    const made = readDesign(json);
    const { ribbon } = made;
    const segment = model.mesh.attributes['segment'] ?? new Float32Array(0);
    const partOfTriangle = partsOfTriangles(ribbon, segment, model.grid);
    let pieces: RibbonPieces | null = null;
    const cut = () => (pieces ??= cutByParts(ribbon, partOfTriangle, model.borders()));
    let bent: Bending | null = null;
    const bending = () => (bent ??= new Bending(ribbon));
    return { design: made, model, course, partOfTriangle, pieces: cut, bending, report };
  }

  /** What a moving slider does not wait for: how far the previewed ribbon is from the model, once it rests. */
  #measureLater(): void {
    let stop: AbortController | null = null;
    effect(() => {
      const shown = this.shown.value;
      const subject = this.model.previewSubject.value;
      stop?.abort();
      this.distances.value = null;
      if (shown?.kind !== 'preview' || this.previews.running.value || subject?.key !== shown.from) return;
      const { signal } = (stop = new AbortController());
      const job = {
        operation: this.operationName,
        parameters: shown.parameters,
        inputs: subject.inputs,
        outputs: [],
      };
      const run = () =>
        this.services.browser.run(job, { signal }).then(
          ({ report }) => {
            if (!signal.aborted) this.distances.value = report;
          },
          () => undefined, // what could be shown without stays
        );
      const waiting = setTimeout(() => void run(), restMs);
      signal.addEventListener('abort', () => clearTimeout(waiting));
    });
  }

  /** Another number of windings is another curve on the same divided model: nothing of it is read again. */
  async #readModel(bytes: Uint8Array<ArrayBuffer>): Promise<DividedModel> {
    const known = this.#divided;
    if (known && sameBytes(known.bytes, bytes)) return known;
    const mesh = await readMesh(bytes);
    const grid = new VertexGrid(mesh.positions);
    let found: PartBorders | null = null;
    const borders = () => (found ??= new PartBorders(mesh, grid));
    const model = { bytes, mesh, grid, borders, distortion: distortionOfParts(mesh) };
    this.#divided = model;
    return model;
  }

  /** Parts and parameterisation are what takes long, and what a second design on the same parts is spared. */
  measured(report: Report): Measured | null {
    const vertices = figure(report, 'vertices');
    const [parts, chart] = [figure(report, 'seconds_parts'), figure(report, 'seconds_parameterisation')];
    if (!vertices || parts === null || !chart || report['reused'] === true) return null;
    return { vertices, seconds: parts + chart + (figure(report, 'seconds_distance') ?? 0) };
  }

  /** Seconds that the whole model may take; null where nothing is known yet. */
  readonly estimate = computed(() => {
    const vertices = figure(this.document.value.model?.report ?? {}, 'vertices') ?? 0;
    return expectedTimes('zippable', vertices, this.#previewed.value);
  });
}

function sameBytes(a: Uint8Array, b: Uint8Array): boolean {
  if (a.byteLength !== b.byteLength) return false;
  for (let i = 0; i < a.length; ++i) if (a[i] !== b[i]) return false;
  return true;
}
