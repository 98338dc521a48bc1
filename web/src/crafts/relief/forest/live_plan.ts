// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps what the core sees in the floor plan in step with the scene: a job for the plan alone solves nothing.
import { computed, effect, signal, untracked } from '@preact/signals';
import type { JsonObject, Report } from '../../../jobs/contract';
import { asJobError } from '../../../jobs/contract';
import { LatestOnly } from '../../../jobs/latest_only';
import { jsonEqual } from '../../../project/document';
import { bytesOf } from '../../../shared/session/import_model';
import type { Companion } from '../../../shared/session/craft_document';
import type { RoomSession } from '../../../shared/session/room_session';
import type { ModelPicture } from './eye/model_pictures';
import { ModelPictures } from './eye/model_pictures';
import type { ForestDocument } from './forest_document';
import { forestOperation, sameScene, subjectOf } from './forest_document';
import type { Plan } from './plan';
import { readPlan } from './plan';
import type { Scene } from './scene';
import { readScene, sceneBytes } from './scene';

interface PlanRequest {
  readonly scene: Scene | null;
  readonly files: readonly Companion[];
  readonly parameters: JsonObject;
}

export interface Planned extends PlanRequest {
  readonly plan: Plan;
  /** With the pillars that a layout made. */
  readonly made: Scene;
  /** Of each viewpoint's model, as it is seen from there. */
  readonly models: readonly ModelPicture[];
  readonly report: Report;
}

const sameRequest = (a: PlanRequest, b: PlanRequest): boolean =>
  jsonEqual(a.parameters, b.parameters) &&
  sameScene(a.scene, b.scene) &&
  subjectOf(null, a.files).key === subjectOf(null, b.files).key;

const requestOf = ({ scene, models, parameters }: ForestDocument): PlanRequest => ({
  scene,
  files: models,
  parameters,
});
const planOutputs = ['plan.json', 'scene.json', 'models.zip'];

export class LivePlan {
  /** The last that the core could make. */
  readonly planned = signal<Planned | null>(null);
  readonly running = signal(false);
  /** Why there is none of the scene as it stands. */
  readonly problem = signal<string | null>(null);
  readonly #room: RoomSession<ForestDocument>;
  readonly #pictures = new ModelPictures();
  readonly #latest = new LatestOnly<PlanRequest>(
    (request, abort) => this.#run(request, abort),
    () => false,
    sameRequest,
  );

  constructor(room: RoomSession<ForestDocument>) {
    this.#room = room;
  }

  startFollowing(): void {
    effect(() => {
      const request = requestOf(this.#room.document.value);
      if (!this.#room.active.value || this.#room.operation.value === null) return;
      untracked(() => {
        const planned = this.planned.value;
        if (planned && sameRequest(planned, request)) {
          this.#latest.cancel();
          this.#settle(null, null);
        } else this.#latest.request(request);
      });
    });
  }

  /** It is of the scene as it stands. */
  readonly fits = computed(() => {
    const planned = this.planned.value;
    return planned !== null && sameRequest(planned, requestOf(this.#room.document.value));
  });

  #settle(field: string | null, message: string | null): void {
    this.problem.value = field === null ? message : null;
    this.#room.fieldErrors.value = field !== null && message !== null ? { [field]: message } : {};
  }

  async #run(request: PlanRequest, signal: AbortSignal): Promise<void> {
    const { browser, projects } = this.#room.services;
    this.running.value = true;
    try {
      const { scene, files, parameters } = request;
      const hash = scene && (await projects.blobs.hold(sceneBytes(scene)));
      const { inputs } = subjectOf(hash, files);
      const job = { operation: forestOperation, parameters, inputs, outputs: planOutputs };
      const result = await browser.run(job, { signal });
      const plan = readPlan(await bytesOf(result, 'plan.json'));
      const made = readScene(await bytesOf(result, 'scene.json'));
      const pictures = await bytesOf(result, 'models.zip');
      if (signal.aborted) return;
      const models = this.#pictures.of(pictures);
      this.planned.value = { ...request, plan, made, models, report: result.report };
      this.#settle(null, null);
    } catch (thrown) {
      const error = asJobError(thrown);
      if (error.code === 'cancelled' || signal.aborted) return;
      const isField = this.#room.operation.value?.parameters.properties[error.where] !== undefined;
      this.#settle(isField ? error.where : null, error.message);
    } finally {
      this.running.value = false;
    }
  }
}
