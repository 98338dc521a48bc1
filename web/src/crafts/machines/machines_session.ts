// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps the job in step with its drawing and parameters. The machine itself is held by MachineControl, whichever room is looked at.
import { computed, effect, signal, untracked } from '@preact/signals';
import type { Catalog, Json, JsonObject, Report } from '../../jobs/contract';
import { asJobError, cancelled, findOperation } from '../../jobs/contract';
import { LatestOnly } from '../../jobs/latest_only';
import { JobLog } from '../../machines/job_log';
import { openVirtual } from '../../machines/links/open_machine';
import { MachineControl } from '../../machines/machine_control';
import type { LaserSheet } from '../../machines/laser_sheet';
import { asOrigin } from '../../machines/places';
import type { MachineProfile } from '../../machines/profiles';
import { isMill, ProfileStore } from '../../machines/profiles';
import { listenForStop } from '../../machines/stop_keys';
import { jsonEqual } from '../../project/document';
import type { CraftResult, SolveRequest, Subject } from '../../shared/session/craft_document';
import { sameRequest } from '../../shared/session/craft_document';
import type { Measured } from '../../shared/session/estimate';
import { estimateSeconds, recall } from '../../shared/session/estimate';
import { figure } from '../../shared/session/report';
import type { Change } from '../../shared/session/room_session';
import { RoomSession } from '../../shared/session/room_session';
import { readyWorker, type Services } from '../../shared/session/services';
import { JobStages } from './job_stages';
import { isOfOther, isUntouched, laserSheet } from './laser_in_use';
import type { FileWork, MachinesDocument } from './machines_document';
import { machines, operationFor } from './machines_document';
import type { Plan, PlanRequest } from './make_plan';
import { keyOf, planOfJob, planOfLaser, planOfResult, sourceOf } from './make_plan';
import { openFiles, takeWork } from './open_work';

/** What the controller reads; the others read G-code. */
const jobFormats: Readonly<Record<string, string>> = { k40: 'job.egv', ruida: 'job.rd' };

export class MachinesSession extends RoomSession<MachinesDocument> {
  readonly document = computed(() => machines.of(this.services.projects.document.value));
  readonly operation = computed(() => this.operationCalled(this.operationName));
  /** The machine's panel is there without a drawing. */
  readonly hasWork = signal(true);
  readonly profiles = new ProfileStore(localStorage);
  readonly log = new JobLog(localStorage);
  readonly control = new MachineControl(this.log);
  /** For who lays out what this project cuts on a laser. */
  readonly laserSheet = computed<LaserSheet | null>(() =>
    laserSheet(this.profiles, this.document.value, this.services.catalog.value),
  );
  readonly plan = signal<Plan | null>(null);
  readonly planning = signal(false);
  /** Seconds from the job's start that the bed shows; null: the end, or where the machine is. */
  readonly playhead = signal<number | null>(null);
  /** The square of a test that came out best. */
  readonly chosenCell = signal<string | null>(null);
  /** What is shown was made with the drawing and the parameters in force: only then it may be started. */
  readonly isCurrent = computed(() => {
    const request = this.#request();
    return request !== null && this.plan.value?.key === keyOf(request);
  });
  /** Which of the plan's jobs comes next. */
  readonly #stages = new JobStages(this.plan, this.control);
  readonly stage = this.#stages.stage;
  readonly job = this.#stages.job;
  readonly jobKey = this.#stages.jobKey;
  /** Where the controller counts from. */
  readonly origin = computed(() => asOrigin(this.value('origin')));
  /** The file that the controller reads. */
  get jobFormat(): string {
    return jobFormats[String(this.value('controller'))] ?? 'job.gcode';
  }
  readonly #latest = new LatestOnly<PlanRequest>(
    (request, abort) => this.#make(request, abort),
    (running, next) => sourceOf(running.work) !== sourceOf(next.work),
    (running, next) => keyOf(running) === keyOf(next),
  );

  get operationName(): string {
    return operationFor(this.document.value.drawing);
  }
  /** A mill's job takes its time: it is made when it is asked for, in the worker where there is one. */
  readonly subject = computed<Subject | null>(() => {
    const { drawing: work } = this.document.value;
    if (work?.kind !== 'model') return null;
    const model = { sha256: work.file.blob, file_name: work.file_name };
    return { key: work.file.blob, inputs: { model } };
  });
  readonly wantedOutputs = [
    'job.gcode',
    'job_1_rough.gcode',
    'job_2_finish.gcode',
    'toolpath.json',
    'carved.ply',
  ];
  readonly asked = computed(() => this.document.value.parameters);
  readonly result = this.unlessLost(
    computed<CraftResult | null>(() => {
      const { parameters } = this.document.value;
      const mesh = this.subject.value?.key;
      return mesh === undefined ? null : this.#madeOf({ mesh, parameters });
    }),
  );
  readonly failedTitle = 'The job could not be made';

  constructor(services: Services) {
    super(services, machines);
    listenForStop(this.control);
    effect(() => this.follow());
    this.#stages.startFollowing();
  }

  chooseStage(stage: number): void {
    this.#stages.choose(stage);
  }

  get needsZ(): boolean {
    return this.#stages.needsZ;
  }

  /** Nodes of the height field stand for the vertices of a mesh. */
  measured(report: Report): Measured | null {
    const { size_mm: size, grid_mm: grid } = report;
    const seconds = figure(report, 'seconds_plan');
    if (!Array.isArray(size) || !Array.isArray(grid) || seconds === null) return null;
    const vertices = (Number(size[0]) / Number(grid[0])) * (Number(size[1]) / Number(grid[1]));
    return vertices > 0 ? { vertices, seconds } : null;
  }
  /** Seconds that a mill's job may take; null where nothing is known yet. */
  readonly estimate_s = computed<number | null>(() => {
    const { drawing: work } = this.document.value;
    const measured = recall(machines.craft, readyWorker(this.services) ? 'native' : 'wasm');
    const nodes = work?.kind === 'model' ? (work.nodes ?? null) : null;
    return measured && nodes ? estimateSeconds(measured, nodes) : null;
  });
  cancelPreview(): void {
    this.#latest.cancel();
  }
  get title(): string {
    return (
      this.document.value.drawing?.file_name.replace(/\.[^.]+$/, '') ??
      this.services.projects.document.value.name
    );
  }
  operationCalled(name: string) {
    const catalog = this.services.catalog.value;
    return (catalog && findOperation(catalog, name)) ?? null;
  }

  #request(): PlanRequest | null {
    const { drawing: work, parameters } = this.document.value;
    return work && { work, parameters };
  }

  protected follow(): void {
    this.cancelOutdatedSolve();
    const request = this.#request();
    if (request === null) {
      this.plan.value = null;
      return;
    }
    if (!this.active.value || this.operation.value === null) return;
    const { result } = this;
    const made = request.work.kind !== 'model' || result.value !== null;
    untracked(() => {
      if (this.plan.value?.key === keyOf(request)) {
        this.#latest.cancel();
        this.fieldErrors.value = {};
      } else if (made) this.#latest.request(request);
      else if (!this.plan.value?.key.startsWith(sourceOf(request.work))) this.plan.value = null;
    });
  }

  async #make(request: PlanRequest, abort: AbortSignal): Promise<void> {
    this.planning.value = true;
    const { work } = request;
    try {
      const plan = await this.#planOf(request, abort);
      if (abort.aborted) return;
      this.plan.value = plan;
      this.chooseStage(0);
      this.playhead.value = null;
      this.fieldErrors.value = {};
      this.problem.value = null;
    } catch (thrown) {
      const error = asJobError(thrown);
      if (error.code === 'cancelled') return;
      if (error.where === 'drawing' || work.kind === 'job') {
        this.plan.value = null;
        this.problem.value = {
          kind: 'file',
          title: `Could not read ${work.file_name}`,
          message: error.message,
        };
      } else if (work.kind === 'model') {
        const made = this.#madeOf({ mesh: work.file.blob, parameters: request.parameters });
        if (made) this.lose(made);
        const message = 'Its files are missing in this browser, or damaged: make it again.';
        this.problem.value = { kind: 'solve', title: 'The job cannot be read', message };
      } else this.report(error, this.failedTitle);
    } finally {
      this.planning.value = false;
    }
  }

  /** The job that a mill's request was answered with. */
  #madeOf(request: SolveRequest): CraftResult | null {
    return this.document.value.results.find((made) => sameRequest(made, request)) ?? null;
  }

  async #planOf(request: PlanRequest, signal: AbortSignal): Promise<Plan> {
    const { work } = request;
    const { blobs } = this.services.projects;
    if (work.kind === 'job') {
      const bed = [this.#number('bed_x_mm', 400), this.#number('bed_y_mm', 400)] as const;
      return await planOfJob(blobs, { ...request, work }, bed, this.#number('power_max_s', 1000));
    }
    if (work.kind === 'model') {
      const made = this.#madeOf({ mesh: work.file.blob, parameters: request.parameters });
      if (made === null) throw cancelled();
      const filled = Object.fromEntries(
        ['x_mm', 'y_mm', 'stock_over_mm'].map((name) => [name, this.#number(name, 0)]),
      );
      return await planOfResult(blobs, request, made, filled);
    }
    return await planOfLaser(this.services.browser, request, this.jobFormat, signal);
  }
  #number(name: string, otherwise: number): number {
    const value = this.value(name);
    return typeof value === 'number' ? value : otherwise;
  }

  // ---- files ----

  get isMill(): boolean {
    return isMill(this.profiles.current);
  }

  openFiles(files: readonly File[]): Promise<boolean> {
    return openFiles(this, files);
  }

  /** Takes up one file (`takeWork`). `own`: what is known of it beside its bytes, for the job and (`more`) for this room. */
  take(
    file_name: string,
    bytes: Uint8Array<ArrayBuffer>,
    kind: FileWork['kind'] = 'drawing',
    own: JsonObject = {},
    more: Pick<FileWork, 'of_plan'> = {},
  ): Promise<boolean> {
    return takeWork(this, { file_name, bytes, kind, own, more });
  }

  // ---- tests of the material ----

  testMaterial(): void {
    const catalog = this.services.catalog.value;
    const { drawing } = this.document.value;
    if (catalog === null || drawing?.kind === 'test') return;
    const work = { file_name: 'Material test', kind: 'test', instead_of: drawing } as const;
    this.takeMachine(catalog, (command) => this.services.projects.do(command));
    this.services.projects.do(machines.setWork(catalog, work, 'Test the material'));
    this.problem.value = null;
  }

  /** Back to what was there before, with what the test has told. */
  endTest(values: JsonObject, label: string): void {
    const catalog = this.services.catalog.value;
    if (catalog) this.services.projects.do(machines.takeFromTest(catalog, values, label));
  }

  // ---- machines ----

  /** Connects the machine of the profile as one that exists on the screen only. */
  practise(): Promise<void> {
    return this.control.connect(this.profiles.current, () => openVirtual(this.driverOptions()), true);
  }

  override value(name: string): Json {
    const own = isUntouched(this.document.value) ? this.profiles.current.parameters[name] : undefined;
    const isKnown = this.operation.value?.parameters.properties[name] !== undefined;
    return own !== undefined && isKnown ? own : super.value(name);
  }

  override setParameters(values: JsonObject, label: string, coalesce?: string): void {
    const { catalog, projects } = this.services;
    if (catalog.value && isUntouched(this.document.value))
      this.takeMachine(catalog.value, (command) => projects.do(command));
    super.setParameters(values, label, coalesce);
  }

  /** New work is for the machine in use: its bed and speeds count where the project has none, or another machine's. */
  takeMachine(catalog: Catalog, change: Change): void {
    const profile = this.profiles.current;
    const untouched = isUntouched(this.document.value);
    if (!untouched && !isOfOther(this.document.value, profile)) return;
    const command = machines.setMachine(catalog, profile, `Use ${profile.name}`);
    change(untouched ? { ...command, recorded: false } : command);
  }

  /** Changes to this machine: its bed and speeds become the job's. */
  useProfile(profile: MachineProfile): void {
    // The rest of a job lies on the machine that began it.
    if (profile.id !== this.profiles.current.id) this.control.cutOff.value = null;
    this.profiles.put(profile);
    const catalog = this.services.catalog.value;
    if (catalog) this.services.projects.do(machines.setMachine(catalog, profile, `Use ${profile.name}`));
    this.services.projects.commit();
  }

  /** What is set now about the machine, as a profile keeps it: also what only other operations know. */
  machineParameters(): JsonObject {
    const operation = this.operation.value;
    const { parameters } = this.profiles.current;
    if (operation === null) return parameters;
    const kept = new Map(Object.entries(parameters));
    for (const [name, schema] of Object.entries(operation.parameters.properties)) {
      const value = this.value(name);
      if (schema['x-group'] !== 'Machine' || jsonEqual(kept.get(name) ?? null, value)) continue;
      if (jsonEqual(value, schema.default ?? null)) kept.delete(name);
      else kept.set(name, value);
    }
    return Object.fromEntries(kept);
  }

  /** Are the machine's values other than its profile says? */
  get profileChanged(): boolean {
    return !jsonEqual(this.machineParameters(), this.profiles.current.parameters);
  }

  /** For the driver: what the profile says, with the bed that the job is made for. */
  driverOptions(): JsonObject {
    const bed = this.bed_mm;
    return { ...this.profiles.current.options, ...(bed ? { bed_x_mm: bed[0], bed_y_mm: bed[1] } : {}) };
  }

  /** Width and depth of the machine's bed. */
  get bed_mm(): readonly [number, number] | null {
    const [x, y] = [this.#number('bed_x_mm', 0), this.#number('bed_y_mm', 0)];
    return x > 0 && y > 0 ? [x, y] : null;
  }
}
