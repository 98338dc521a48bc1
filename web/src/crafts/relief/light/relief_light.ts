// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps the lit relief in step with the relief that is shown and with the light chosen.
import type { ReadonlySignal } from '@preact/signals';
import { computed, effect, signal, untracked } from '@preact/signals';
import type { Backend, RunOptions } from '../../../jobs/backend';
import type { Job, Json, JsonObject } from '../../../jobs/contract';
import { asJobError, findOperation } from '../../../jobs/contract';
import { LatestOnly } from '../../../jobs/latest_only';
import { readPly } from '../../../jobs/mesh_reader';
import { jsonEqual } from '../../../project/document';
import { download, safeFileName } from '../../../shared/session/download';
import { bytesOf } from '../../../shared/session/import_model';
import { readyWorker } from '../../../shared/session/services';
import type { Subject } from '../../../shared/session/craft_document';
import type { RoomSession } from '../../../shared/session/room_session';
import type { ReliefDocument } from '../relief_document';
import type { LitRelief, Shown } from '../shown';
import { lightOperation, lightParameters, setLight, srgbOf } from './light_values';

/** What it needs of the room. */
type LightRoom = Pick<
  RoomSession<ReliefDocument>,
  'services' | 'document' | 'active' | 'subject' | 'title' | 'busy'
> & {
  readonly shown: ReadonlySignal<Shown | null>;
  readonly fits: ReadonlySignal<boolean>;
  readonly model: { readonly previewSubject: ReadonlySignal<Subject | null> };
};

interface LightRequest {
  readonly shown: Shown;
  readonly job: Job;
  readonly backend: Backend;
}

export class ReliefLight {
  /** The view shows it: only then is it kept up to date. */
  readonly open = signal(false);
  readonly lit = signal<LitRelief | null>(null);
  readonly running = signal(false);
  readonly errors = signal<Readonly<Record<string, string>>>({});
  /** Why there is none, where no field is to blame. */
  readonly problem = signal<string | null>(null);
  readonly operation = computed(() => {
    const catalog = this.#room.services.catalog.value;
    return catalog === null ? null : (findOperation(catalog, lightOperation) ?? null);
  });
  readonly #room: LightRoom;
  readonly #latest = new LatestOnly<LightRequest>(
    (request, abort) => this.#run(request, abort),
    (running, next) => running.shown !== next.shown,
    (running, next) => running.shown === next.shown && jsonEqual(running.job.parameters, next.job.parameters),
  );

  constructor(room: LightRoom) {
    this.#room = room;
  }

  startFollowing(): void {
    effect(() => {
      const request = this.open.value && this.#room.active.value ? this.#request(['light.ply']) : null;
      untracked(() => {
        if (request) this.#latest.request(request);
        else this.#latest.cancel();
      });
    });
  }

  values(): JsonObject {
    return this.#room.document.value.light;
  }

  preview(name: string, value: Json): void {
    const operation = this.operation.value;
    if (operation) this.#room.services.projects.do(setLight(operation, { [name]: value }, `light ${name}`));
  }

  /** Finished by a press: one step to undo. */
  set(name: string, value: Json): void {
    this.preview(name, value);
    this.#room.services.projects.commit();
  }

  /** Makes one of the other files in this light and hands it to the browser. */
  async save(name: string, label: string): Promise<void> {
    const request = this.#request([name]);
    if (request === null) return;
    const fileName = `${safeFileName(this.#room.title)}-${name}`;
    const bytes = await this.#room.busy(
      'exporting',
      label,
      async (options: RunOptions) => await bytesOf(await request.backend.run(request.job, options), name),
      (error) => (this.problem.value = error.message),
    );
    const declared = this.operation.value?.outputs.find((output) => output.name === name);
    if (bytes && declared) download(bytes, fileName, declared.media_type);
  }

  #request(outputs: readonly string[]): LightRequest | null {
    const room = this.#room;
    const operation = this.operation.value;
    const shown = room.shown.value;
    const { light } = room.document.value;
    const full = shown?.kind === 'full';
    const subject = full ? room.subject.value : room.model.previewSubject.value;
    if (operation === null || shown === null || subject === null || !room.fits.value) return null;
    const parameters = lightParameters(operation, shown.parameters, light, full ? null : shown);
    const job = { operation: lightOperation, parameters, inputs: subject.inputs, outputs };
    const backend = (full ? readyWorker(room.services) : null) ?? room.services.browser;
    return { shown, job, backend };
  }

  async #run({ shown, job, backend }: LightRequest, signal: AbortSignal): Promise<void> {
    this.running.value = true;
    try {
      const result = await backend.run(job, { signal });
      const { positions, indices, attributes } = await readPly(await bytesOf(result, 'light.ply'));
      if (signal.aborted) return;
      const brightness = srgbOf(attributes['brightness'] ?? new Float32Array(positions.length / 3));
      this.errors.value = {};
      this.problem.value = null;
      this.lit.value = { positions, indices, brightness, report: result.report, of: shown };
    } catch (thrown) {
      const error = asJobError(thrown);
      if (error.code === 'cancelled' || signal.aborted) return;
      const field = this.operation.value?.parameters.properties[error.where]?.['x-group'] === 'Light';
      this.errors.value = field ? { [error.where]: error.message } : {};
      this.problem.value = field ? null : error.message;
    } finally {
      this.running.value = false;
    }
  }
}
