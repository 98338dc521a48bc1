// SPDX-License-Identifier: GPL-3.0-or-later
// What the thermoforming page does beyond opening models: forms a coarse sheet at every change, shows what was
// formed in full, keeps the moment of the film that is looked at.
import { computed, effect, signal } from '@preact/signals';
import type { JsonObject, Operation, Report } from '../../jobs/contract';
import { findOperation } from '../../jobs/contract';
import type { Film } from '../../jobs/glb';
import { readFilm, readPly } from '../../jobs/mesh_reader';
import type { PlyMesh } from '../../jobs/ply';
import type { CraftResult } from '../../shared/session/craft_document';
import { inForce, known } from '../../shared/session/craft_document';
import type { Measured } from '../../shared/session/estimate';
import { expectedTimes } from '../../shared/session/estimate';
import { bytesOf } from '../../shared/session/import_model';
import { machineProfile, profileInputs, withProfile } from '../../shared/session/machine_profile';
import { OpenedModel } from '../../shared/session/opened_model';
import type { PreviewRequest, ShownWork } from '../../shared/session/previews';
import { Previews } from '../../shared/session/previews';
import { productOf } from '../../shared/session/products';
import { figure } from '../../shared/session/report';
import { RoomSession } from '../../shared/session/room_session';
import type { Services } from '../../shared/session/services';
import { endOf, momentAt, phaseAt, phasesOf } from './film';
import { carriedOn, placementOf } from './placement';
import {
  formedSheet,
  hasMaterials,
  moulding,
  offered,
  printing,
  simulate,
  thermoform,
} from './thermoform_document';
import type { ThermoformDocument } from './thermoform_document';

export interface Formed extends ShownWork {
  readonly sheet: PlyMesh;
  readonly film: Film;
  /** Of a preview: sheet.ply, which no project keeps. */
  readonly sheetFile?: Uint8Array<ArrayBuffer>;
}

/** Coarse enough to re-form while the model is dragged. */
const previewTriangles = 2500;
/** A preview that has run longer than this is given up for a newer one. */
const patience_ms = 1500;

export class ThermoformSession extends RoomSession<ThermoformDocument> {
  readonly operationName = simulate;
  readonly wantedOutputs = ['sheet.ply', 'forming.glb'];
  readonly failedTitle = 'Could not form the sheet';
  readonly document = computed(() => thermoform.of(this.services.projects.document.value));
  readonly profile = computed(() => machineProfile.of(this.services.projects.document.value).profile);
  readonly operation = computed<Operation | null>(() => {
    const catalog = this.services.catalog.value;
    const operation = catalog && offered(catalog);
    return operation && withProfile(operation, this.profile.value);
  });
  readonly model: OpenedModel<ThermoformDocument> = new OpenedModel(this, {
    commands: thermoform,
    inputName: 'mould',
    furtherInputs: computed(() => profileInputs(this.profile.value)),
    // Size and place belonged to the old model; sheet and machine are still the same.
    forgets: (name) => this.operation.value?.parameters.properties[name]?.['x-group'] === 'Placement',
  });
  /** The model's own, once it is read; null where it has none. */
  readonly picture = signal<ImageBitmap | null>(null);
  /** Whether the model's file says which colours it has. */
  readonly hasColours = computed(() => {
    const { model } = this.document.value;
    if (model === null) return false;
    const ofVertices = this.model.original.value?.mesh.colours;
    return Boolean(ofVertices ?? model.picture) || hasMaterials(model.source);
  });
  readonly hasWork = this.model.isThere;
  readonly subject = this.model.subject;
  readonly asked = computed(() => known(this.operationNamed(simulate), this.document.value.parameters));
  /** What forming depends on, with defaults filled in. */
  readonly inForce = computed(() => this.filled(this.asked.value));
  readonly result = this.unlessLost(
    computed(() => formedSheet(this.document.value, this.subject.value, this.asked.value)),
  );
  readonly previews = new Previews<ThermoformDocument, Formed>(this, {
    shownOutputs: this.wantedOutputs,
    failedTitle: 'Could not preview the forming',
    make: (request, signal) => this.#makePreview(request, signal),
    read: (result) => this.#readResult(result),
    patience_ms, // a coarse sheet takes so little that only a long wait is worth giving up
    present: (formed, show) => this.#present(formed, show),
  });
  readonly shown = this.previews.shown;
  readonly print = computed(() =>
    productOf(this.document.value, this.subject.value?.key ?? null, this.operationNamed(printing)),
  );
  readonly mould = computed(() =>
    productOf(this.document.value, this.subject.value?.key ?? null, this.operationNamed(moulding)),
  );
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
  /** Where the model stands with the parameters in force. */
  readonly placement = computed(() => {
    const shown = this.shown.value;
    const original = this.model.original.value;
    const reported = shown && placementOf(shown.report);
    if (shown === null || original === null || reported === null) return null;
    const from = this.filled(shown.parameters);
    return carriedOn(reported, from, this.inForce.value, original.mesh.positions) ?? reported;
  });
  readonly #previewed = signal<Measured | null>(null);

  constructor(services: Services) {
    super(services, thermoform);
    this.previews.startFollowing();
    effect(() => {
      const blob = this.document.value.model?.picture?.blob ?? null;
      if (this.active.value) void this.#readPicture(blob);
    });
  }

  #pictureFrom: string | null = null;
  async #readPicture(blob: string | null): Promise<void> {
    if (blob === this.#pictureFrom) return;
    this.#pictureFrom = blob;
    this.picture.value = null;
    if (blob === null) return;
    try {
      const bytes = await this.services.projects.blobs.read(blob);
      const picture = await createImageBitmap(new Blob([bytes]), { imageOrientation: 'flipY' });
      if (this.#pictureFrom === blob) this.picture.value = picture;
    } catch {
      // A picture that the browser cannot read leaves the model plain; the print's own note says what is wrong with it.
    }
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

  operationNamed(name: string): Operation | undefined {
    const catalog = this.services.catalog.value;
    const operation = catalog ? findOperation(catalog, name) : undefined;
    return operation && withProfile(operation, this.profile.value);
  }

  /** With defaults filled in. */
  filled(parameters: JsonObject): JsonObject {
    const operation = this.operationNamed(simulate);
    if (operation === undefined) return parameters;
    const names = Object.keys(operation.parameters.properties);
    return Object.fromEntries(names.map((name) => [name, inForce(operation, parameters, name)]));
  }

  async #readResult({ outputs, report, parameters, mesh }: CraftResult): Promise<Formed> {
    const { blobs } = this.services.projects;
    const sheet = await readPly(await blobs.read(outputs['sheet.ply']?.blob ?? ''));
    const film = await readFilm(await blobs.read(outputs['forming.glb']?.blob ?? ''));
    return { kind: 'full', sheet, film, report, parameters, from: mesh };
  }

  async #makePreview({ subject, parameters }: PreviewRequest, signal: AbortSignal): Promise<Formed> {
    const triangles = Math.min(previewTriangles, Number(this.filled(parameters)['triangles'] ?? Infinity));
    const job = {
      operation: simulate,
      parameters: { ...parameters, triangles },
      inputs: subject.inputs,
      outputs: this.wantedOutputs,
    };
    const done = await this.services.browser.run(job, { signal });
    const sheetFile = await bytesOf(done, 'sheet.ply');
    const sheet = await readPly(sheetFile);
    const film = await readFilm(await bytesOf(done, 'forming.glb'));
    this.#previewed.value = this.measured(done.report) ?? this.#previewed.value;
    return { kind: 'preview', sheet, sheetFile, film, report: done.report, parameters, from: subject.key };
  }

  /** Keeps the moment looked at; who looked at the end goes on doing so. */
  #present(formed: Formed, show: () => void): void {
    const before = this.shown.value?.film;
    const atEnd = before === undefined || this.time_s.value >= endOf(before) - 1e-6;
    show();
    const end = endOf(formed.film);
    this.time_s.value = atEnd ? end : Math.min(this.time_s.value, end);
  }

  /** The sheet's vertices are what a simulation's time grows with. */
  measured(report: Report): Measured | null {
    const seconds = figure(report, 'seconds_simulation');
    const vertices = figure(report, 'vertices');
    return seconds && vertices && report['reused'] !== true ? { vertices, seconds } : null;
  }

  /** Seconds that forming in full may take; null where nothing is known yet. */
  readonly estimate = computed(() =>
    expectedTimes('thermoform', Number(this.value('triangles') ?? 0) / 2, this.#previewed.value),
  );
}
