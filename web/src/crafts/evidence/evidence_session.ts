// SPDX-License-Identifier: GPL-3.0-or-later
// What the evidence room does: takes up measured objects, shows each beside its simulation at once, and what a calibration
// or diagnosis found once one was made.
import { computed, effect, signal, untracked } from '@preact/signals';
import type { JsonObject, Operation, Report } from '../../jobs/contract';
import { asJobError, findOperation, JobError } from '../../jobs/contract';
import { LatestOnly } from '../../jobs/latest_only';
import { isObject } from '../../project/document';
import type { CraftResult } from '../../shared/session/craft_document';
import { inForce, known, sameRequest, withoutDefaults } from '../../shared/session/craft_document';
import type { Measured } from '../../shared/session/estimate';
import { estimateSeconds, recall } from '../../shared/session/estimate';
import { solveInFull } from '../../shared/session/full_solve';
import { bytesOf } from '../../shared/session/import_model';
import { machineProfile } from '../../shared/session/machine_profile';
import { figure } from '../../shared/session/report';
import { RoomSession } from '../../shared/session/room_session';
import type { Services } from '../../shared/session/services';
import { readDiagnosis } from '../../shared/diagnosis/diagnosis';
import type { EvidenceDocument, MeasuredObject, ObjectFile } from './evidence_document';
import { comparing, evidence, objectFiles, operationOf, subjectOf } from './evidence_document';
import { sortFiles } from './objects/measured_files';
import type { Model, Residuals } from './pictures/residuals';
import { readResiduals } from './pictures/residuals';
import { takeObject, takeScan } from './objects/take_files';

/** A measured object beside its simulation. */
export interface Look {
  /** `quick`: the set-up as it stands, coarse; `diagnosis`: fitted, with and without what was found. */
  readonly kind: 'quick' | 'diagnosis';
  readonly pack: string;
  /** The result it is of. */
  readonly result: string | null;
  readonly residuals: Residuals;
  /** Standard deviation of one measured coordinate, as stated or found; 0 where nobody says. */
  readonly sigma_mm: number;
  /** Mean distance that noise alone gives. */
  readonly noiseFloor_mm: number | null;
  readonly report: Report;
  readonly opening_mm: readonly [number, number] | null;
}

/** Enough to see where a sheet is off, within seconds. */
const quickTriangles = 2000;
/** What runs have taken so far, to tell the time of the first one: simulations (one on twice the triangles counts as two), and a worker's time as a share of the page's. */
const usualSimulations = { diagnose: 600, pairs: 200, calibrate: 100 };
const workerShare = 0.5;

export class EvidenceSession extends RoomSession<EvidenceDocument> {
  readonly failedTitle = 'Could not explain the difference';
  readonly document = computed(() => evidence.of(this.services.projects.document.value));
  readonly mode = computed(() => this.document.value.mode);
  readonly hasWork = computed(() => {
    const { objects, draft, scan, byHand } = this.document.value;
    return objects.length > 0 || draft !== null || scan !== null || byHand !== null;
  });
  readonly operation = computed(() => this.operationNamed(operationOf(this.mode.value)) ?? null);
  readonly subject = computed(() => subjectOf(this.document.value));
  readonly asked = computed<JsonObject>(() => {
    const operation = this.operation.value;
    const { parameters } = this.document.value;
    return operation ? withoutDefaults(operation, known(operation, parameters)) : {};
  });
  readonly result = computed<CraftResult | null>(() => {
    const subject = this.subject.value;
    const request = { mesh: subject?.key ?? '', parameters: this.asked.value };
    return this.document.value.results.find((result) => sameRequest(result, request)) ?? null;
  });
  readonly diagnosis = computed(() => {
    const result = this.result.value;
    return result && this.mode.value === 'diagnose' ? readDiagnosis(result.report) : null;
  });
  /** The object looked at. */
  readonly chosenId = signal<string | null>(null);
  readonly chosen = computed<MeasuredObject | null>(() => {
    const { objects } = this.document.value;
    const byUse = objects.find(({ use }) => use === 'fit') ?? objects[0] ?? null;
    return objects.find(({ id }) => id === this.chosenId.value) ?? byUse;
  });
  readonly look = signal<Look | null>(null);
  /** Which simulation is shown beside the measurement. */
  readonly extended = signal(false);
  readonly model = computed<Model>(() =>
    this.extended.value && this.look.value?.residuals.extended ? 'extended' : 'base',
  );
  /** Number of the point that all views mark. */
  readonly hovered = signal<number | null>(null);
  /** A run was ended before it was done. */
  readonly stopped = signal(false);
  readonly looking = signal(false);
  /** Quick looks by the hash of their object. */
  readonly quick = signal<ReadonlyMap<string, Look>>(new Map());
  readonly #comparison = new LatestOnly<MeasuredObject>(
    (object, abort) => this.#compare(object, abort),
    (running, next) => running.pack.blob !== next.pack.blob,
    (running, next) => running.pack.blob === next.pack.blob,
  );

  constructor(services: Services) {
    super(services, evidence);
    effect(() => this.follow());
    effect(() => {
      if (this.look.value === null) this.hovered.value = null;
    });
  }

  get operationName(): string {
    return operationOf(this.mode.value);
  }

  get wantedOutputs(): readonly string[] {
    return this.operation.value?.outputs.map(({ name }) => name) ?? [];
  }

  get title(): string {
    return this.chosen.value?.name ?? 'Evidence';
  }

  operationNamed(name: string): Operation | undefined {
    const catalog = this.services.catalog.value;
    return catalog ? findOperation(catalog, name) : undefined;
  }

  cancelPreview(): void {
    this.#comparison.cancel();
  }

  // ---- what is shown ----

  protected follow(): void {
    const object = this.chosen.value;
    const result = this.result.value;
    if (!this.active.value || this.operation.value === null) return;
    this.cancelOutdatedSolve();
    untracked(() => {
      if (object === null) this.look.value = null;
      else if (result && this.mode.value === 'diagnose' && object.use !== 'off')
        void this.#showResult(result, object);
      else this.#lookQuickly(object);
    });
  }

  #lookQuickly(object: MeasuredObject): void {
    const kept = this.quick.value.get(object.pack.blob);
    this.look.value = kept ?? null;
    if (kept) this.cancelPreview();
    else this.#comparison.request(object);
  }

  async #showResult(result: CraftResult, object: MeasuredObject): Promise<void> {
    const { look } = this;
    if (look.value?.result === result.id && look.value.pack === object.pack.blob) return;
    if (look.value?.pack !== object.pack.blob) look.value = null;
    this.cancelPreview();
    try {
      const csv = await this.services.projects.blobs.read(result.outputs['residuals.csv']?.blob ?? '');
      const residuals = readResiduals(new TextDecoder().decode(csv)).get(object.name);
      if (residuals === undefined) throw new Error('Another object.');
      const opening_mm = await this.#openingOf(object);
      if (this.result.value?.id !== result.id || this.chosen.value?.id !== object.id) return;
      const { sigma_mm, noiseFloor_mm } = readDiagnosis(result.report);
      look.value = {
        kind: 'diagnosis',
        pack: object.pack.blob,
        result: result.id,
        residuals,
        sigma_mm: sigma_mm.get(object.name) ?? 0,
        noiseFloor_mm,
        report: result.report,
        opening_mm,
      };
    } catch {
      // Its points were not kept; the quick look stands in for them.
      if (this.chosen.value?.id === object.id) this.#lookQuickly(object);
    }
  }

  async #compare(object: MeasuredObject, signal: AbortSignal): Promise<void> {
    this.looking.value = true;
    try {
      const input = (name: ObjectFile) => ({ sha256: object.files[name].blob, file_name: name });
      const done = await this.services.browser.run(
        {
          operation: comparing,
          parameters: { triangles: quickTriangles },
          inputs: {
            mould: input('mould.obj'),
            setup: input('setup.json'),
            measured: input('measured.csv'),
          },
          outputs: ['residuals.csv'],
        },
        { signal },
      );
      const csv = new TextDecoder().decode(await bytesOf(done, 'residuals.csv'));
      const residuals = readResiduals(csv).get('');
      if (residuals === undefined) return;
      const look: Look = {
        kind: 'quick',
        pack: object.pack.blob,
        result: null,
        residuals,
        sigma_mm: figure(done.report, 'sigma_mean_mm') ?? 0,
        noiseFloor_mm: null,
        report: done.report,
        opening_mm: await this.#openingOf(object),
      };
      this.quick.value = new Map([...this.quick.value, [object.pack.blob, look]]);
      const shown = this.look.value?.pack === object.pack.blob;
      if (!shown && this.chosen.value?.pack.blob === object.pack.blob) this.look.value = look;
    } catch (thrown) {
      const error = asJobError(thrown);
      if (error.code !== 'cancelled' && !signal.aborted)
        this.report(error, `Could not simulate ${object.name}`);
    } finally {
      this.looking.value = false;
    }
  }

  /** Where the clamp holds the sheet, as the set-up says; a picture can do without. */
  async #openingOf(object: MeasuredObject): Promise<readonly [number, number] | null> {
    try {
      const bytes = await this.services.projects.blobs.read(object.files['setup.json'].blob);
      const setup = JSON.parse(new TextDecoder().decode(bytes)) as unknown;
      const opening = isObject(setup) ? setup['clamp_opening_mm'] : null;
      if (!Array.isArray(opening) || opening.length !== 2) return null;
      const [x, y] = opening as readonly unknown[];
      return typeof x === 'number' && typeof y === 'number' ? [x, y] : null;
    } catch {
      return null;
    }
  }

  // ---- objects ----

  async openFiles(files: readonly File[]): Promise<boolean> {
    const name = files.length === 1 ? (files[0]?.name ?? '') : `${files.length} files`;
    const opened = await this.busy(
      'opening',
      name,
      async (options) => {
        const { objects, scan, strange } = await sortFiles(files);
        if (scan.length > 0) await takeScan(this, scan, options.do);
        for (const found of objects) await takeObject(this, found, options.do);
        if (strange.length > 0 && objects.length + scan.length === 0)
          throw new JobError({
            code: 'invalid_input',
            where: '',
            message: `A measured object consists of ${objectFiles.join(', ')}: drop these three files together, their folder, or a zip archive of it.`,
          });
        return true;
      },
      ({ message }) => (this.problem.value = { kind: 'file', title: `Could not open ${name}`, message }),
    );
    return opened ?? false;
  }

  // ---- runs ----

  async solve(): Promise<void> {
    const { document } = this.services.projects;
    const home = document.value.id;
    this.stopped.value = false;
    await solveInFull(this);
    const isOpen = document.value.id === home; // of another project nothing was stopped
    this.stopped.value = isOpen && this.result.value === null && this.problem.value === null;
  }

  measured(report: Report): Measured | null {
    const seconds = figure(report, 'seconds_diagnosis');
    const expected = this.#firstGuess.value;
    // A run that found its simulations made says nothing about the next.
    const reused =
      expected !== null && seconds !== null && seconds < 0.1 * estimateSeconds(expected, this.#triangles());
    return seconds && !reused ? { vertices: this.#triangles(), seconds } : null;
  }

  #triangles(): number {
    const operation = this.operation.value;
    return Number((operation && inForce(operation, this.document.value.parameters, 'triangles')) ?? 0);
  }

  /** As many times the quick look as runs usually simulate. */
  readonly #firstGuess = computed<Measured | null>(() => {
    const objects = this.document.value.objects.filter(({ use }) => use === 'fit').length;
    const object = this.chosen.value;
    const quick = object && this.quick.value.get(object.pack.blob)?.report['seconds_simulation'];
    const runs =
      this.mode.value === 'calibrate'
        ? usualSimulations.calibrate
        : usualSimulations.diagnose + (this.value('pairs') === true ? usualSimulations.pairs : 0);
    return typeof quick === 'number' && quick > 0
      ? { vertices: quickTriangles, seconds: quick * runs * Math.max(1, objects) }
      : null;
  });

  /** Seconds that a run may take; null where nothing is known yet. */
  readonly estimate = computed(() => {
    const triangles = this.#triangles();
    const mode = this.mode.value;
    const recalled = (backend: string) => (mode === 'diagnose' ? recall('evidence', backend) : null);
    const guess = this.#firstGuess.value;
    const browser = recalled('wasm') ?? guess;
    const worker = recalled('native') ?? (guess && { ...guess, seconds: workerShare * guess.seconds });
    return {
      browser_s: browser && estimateSeconds(browser, triangles),
      worker_s: worker && estimateSeconds(worker, triangles),
    };
  });

  /** Later sheets, prints and moulds of this project are made for the machine as it was found. */
  async useProfile(): Promise<void> {
    const file = this.result.value?.outputs['profile.json'];
    if (file === undefined) return;
    const from = this.diagnosis.value?.sentence ?? 'Calibrated material.';
    await this.busy(
      'opening',
      'the machine profile',
      async (options) => {
        const bytes = await this.services.projects.blobs.read(file.blob);
        const profile = JSON.parse(new TextDecoder().decode(bytes)) as unknown;
        const said = isObject(profile) ? profile : {};
        const name = typeof said['name'] === 'string' ? said['name'] : 'Machine';
        const parameters = isObject(said['parameters']) ? said['parameters'] : {};
        options.do(machineProfile.use({ name, from, file, parameters }));
      },
      ({ message }) => (this.problem.value = { kind: 'file', title: 'The profile cannot be read', message }),
    );
  }

  readonly profileUsed = computed(() => {
    const used = machineProfile.of(this.services.projects.document.value).profile;
    const own = this.result.value?.outputs['profile.json'];
    return used !== null && own !== undefined && used.file.blob === own.blob;
  });
}
