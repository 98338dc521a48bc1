// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps the job in step with its drawing and parameters. The machine itself is held by MachineControl, whichever room is looked at.
import { computed, effect, signal, untracked } from '@preact/signals';
import type { JsonObject, Report } from '../../jobs/contract';
import { asJobError, findOperation } from '../../jobs/contract';
import { LatestOnly } from '../../jobs/latest_only';
import { readGcodePath } from '../../machines/gcode_path';
import { JobLog } from '../../machines/job_log';
import { MachineControl } from '../../machines/machine_control';
import type { MachineProfile } from '../../machines/profiles';
import { ProfileStore } from '../../machines/profiles';
import { asOrigin } from '../../machines/places';
import { listenForStop } from '../../machines/stop_keys';
import type { ToolPath } from '../../machines/toolpath';
import { readToolPath } from '../../machines/toolpath';
import { jsonEqual } from '../../project/document';
import type { CraftResult, Subject } from '../common/craft_document';
import { nameProject, withoutDefaults } from '../common/craft_document';
import { bytesOf } from '../common/import_model';
import { sentences } from '../common/report';
import { RoomSession } from '../common/room_session';
import type { Services } from '../common/services';
import type { Drawing, MachinesDocument } from './machines_document';
import { drawingEndings, jobEndings, laserJob, machines } from './machines_document';

/** A job that is ready to be looked at, and to be sent unless it does not fit. */
export interface Plan {
  readonly key: string;
  readonly report: Report;
  readonly toolPath: ToolPath;
  readonly job: Uint8Array<ArrayBuffer> | null;
  readonly misfits: readonly string[];
}

interface Request {
  readonly drawing: Drawing;
  readonly parameters: JsonObject;
}
const keyOf = ({ drawing, parameters }: Request) =>
  `${drawing.kind} ${drawing.file.blob} ${JSON.stringify(parameters)}`;

/** What the controller reads; the others read G-code. */
const jobFormats: Readonly<Record<string, string>> = { k40: 'job.egv', ruida: 'job.rd' };

export class MachinesSession extends RoomSession<MachinesDocument> {
  readonly document = computed(() => machines.of(this.services.projects.document.value));
  readonly operation = computed(() => {
    const catalog = this.services.catalog.value;
    return (catalog && findOperation(catalog, laserJob)) ?? null;
  });
  /** The machine's panel is there without a drawing. */
  readonly hasWork = signal(true);
  readonly profiles = new ProfileStore(localStorage);
  readonly log = new JobLog(localStorage);
  readonly control = new MachineControl(this.log);
  readonly plan = signal<Plan | null>(null);
  readonly planning = signal(false);
  /** Seconds from the job's start that the bed shows; null: the end, or where the machine is. */
  readonly playhead = signal<number | null>(null);
  /** What is shown was made with the drawing and the parameters in force: only then it may be started. */
  readonly isCurrent = computed(() => {
    const { drawing, parameters } = this.document.value;
    return drawing !== null && this.plan.value?.key === keyOf({ drawing, parameters });
  });
  /** Where the controller counts from. */
  readonly origin = computed(() => asOrigin(this.value('origin')));
  /** The file that the controller reads. */
  get jobFormat(): string {
    return jobFormats[String(this.value('controller'))] ?? 'job.gcode';
  }
  readonly #latest = new LatestOnly<Request>(
    (request, abort) => this.#make(request, abort),
    (running, next) => running.drawing.file.blob !== next.drawing.file.blob,
    (running, next) => keyOf(running) === keyOf(next),
  );

  readonly operationName = laserJob;
  readonly subject = computed<Subject | null>(() => null);
  readonly wantedOutputs = ['job.gcode', 'toolpath.json'];
  readonly asked = computed(() => this.document.value.parameters);
  readonly result = computed<CraftResult | null>(() => null);
  readonly failedTitle = 'The job could not be made';

  constructor(services: Services) {
    super(services, machines);
    listenForStop(this.control);
    effect(() => this.follow());
  }

  measured(): null {
    return null;
  }
  cancelPreview(): void {
    this.#latest.cancel();
  }
  get title(): string {
    return (
      this.document.value.drawing?.file_name.replace(/\.[^.]+$/, '') ??
      this.services.projects.document.value.name
    );
  }

  protected follow(): void {
    const { drawing, parameters } = this.document.value;
    if (drawing === null) {
      this.plan.value = null;
      return;
    }
    if (!this.active.value || this.operation.value === null) return;
    const request = { drawing, parameters };
    untracked(() => {
      if (this.plan.value?.key === keyOf(request)) {
        this.#latest.cancel();
        this.fieldErrors.value = {};
      } else this.#latest.request(request);
    });
  }

  async #make(request: Request, abort: AbortSignal): Promise<void> {
    this.planning.value = true;
    try {
      const made =
        request.drawing.kind === 'job' ? await this.#readJob(request) : await this.#makeJob(request, abort);
      if (abort.aborted) return;
      this.plan.value = { key: keyOf(request), ...made };
      this.playhead.value = null;
      this.fieldErrors.value = {};
      this.problem.value = null;
    } catch (thrown) {
      const error = asJobError(thrown);
      if (error.code === 'cancelled') return;
      if (error.where === 'drawing' || request.drawing.kind === 'job') {
        this.plan.value = null;
        this.problem.value = {
          kind: 'file',
          title: `Could not read ${request.drawing.file_name}`,
          message: error.message,
        };
      } else this.report(error, this.failedTitle);
    } finally {
      this.planning.value = false;
    }
  }

  async #makeJob({ drawing, parameters }: Request, signal: AbortSignal) {
    const inputs = { drawing: { sha256: drawing.file.blob, file_name: drawing.file_name } };
    const format = this.jobFormat;
    const result = await this.services.browser.run(
      { operation: laserJob, parameters, inputs, outputs: [format, 'toolpath.json'] },
      { signal },
    );
    const toolPath = readToolPath(new TextDecoder().decode(await bytesOf(result, 'toolpath.json')));
    const job = result.outputs.has(format) ? await bytesOf(result, format) : null;
    return { report: result.report, toolPath, job, misfits: sentences(result.report, 'misfits') };
  }

  async #readJob({ drawing }: Request) {
    const job = await this.services.projects.blobs.read(drawing.file.blob);
    const number = (name: string) => {
      const value = this.value(name);
      return typeof value === 'number' ? value : 400;
    };
    const bed = [number('bed_x_mm'), number('bed_y_mm')] as const;
    const toolPath = readGcodePath(new TextDecoder().decode(job), bed, number('power_max_s'));
    return { report: {}, toolPath, job, misfits: [] };
  }

  /** Takes up one drawing or job; false where the file is neither. */
  async openFiles(files: readonly File[]): Promise<boolean> {
    const [file] = files;
    if (file === undefined) return false;
    const name = file.name.toLowerCase();
    const kind = jobEndings.some((ending) => name.endsWith(ending)) ? 'job' : 'drawing';
    if (kind === 'drawing' && !drawingEndings.some((ending) => name.endsWith(ending))) {
      this.problem.value = {
        kind: 'file',
        title: `Could not open ${file.name}`,
        message: `Machines take drawings (${drawingEndings.join(', ')}) and jobs (${jobEndings.join(', ')}): models go to the other places, which make drawings of them.`,
      };
      return false;
    }
    await this.take(file.name, new Uint8Array(await file.arrayBuffer()), kind);
    return true;
  }

  async take(
    file_name: string,
    bytes: Uint8Array<ArrayBuffer>,
    kind: Drawing['kind'] = 'drawing',
  ): Promise<void> {
    const file = await this.keep(bytes, kind === 'job' ? 'text/x-gcode' : 'image/svg+xml');
    const blank = this.services.projects.isBlank.value;
    this.problem.value = null;
    this.services.projects.do(machines.setDrawing({ file_name, kind, file }));
    if (blank) this.services.projects.do(nameProject(file_name.replace(/\.[^.]+$/, '')));
  }

  // ---- machines ----

  /** Changes to this machine: its bed and speeds become the job's. */
  useProfile(profile: MachineProfile): void {
    this.profiles.put(profile);
    const operation = this.operation.value;
    if (operation === null) return;
    const machineDefaults = Object.fromEntries(
      Object.entries(operation.parameters.properties)
        .filter(([, schema]) => schema['x-group'] === 'Machine')
        .map(([name, schema]) => [name, schema.default ?? null]),
    );
    this.setParameters({ ...machineDefaults, ...profile.parameters }, `Use ${profile.name}`);
  }

  /** What is set now about the machine, as a profile keeps it. */
  machineParameters(): JsonObject {
    const operation = this.operation.value;
    if (operation === null) return {};
    const { parameters } = this.document.value;
    const ofMachine = ([name]: readonly [string, unknown]) =>
      operation.parameters.properties[name]?.['x-group'] === 'Machine';
    return withoutDefaults(operation, Object.fromEntries(Object.entries(parameters).filter(ofMachine)));
  }

  /** Are the machine's values other than its profile says? */
  get profileChanged(): boolean {
    return !jsonEqual(this.machineParameters(), this.profiles.current.parameters);
  }

  /** For the driver: what the profile says, with the bed that the job is made for. */
  driverOptions(): JsonObject {
    const [bed_x_mm, bed_y_mm] = [this.value('bed_x_mm'), this.value('bed_y_mm')];
    return { ...this.profiles.current.options, ...(bed_x_mm && bed_y_mm ? { bed_x_mm, bed_y_mm } : {}) };
  }
}
