// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps the lit relief in step with the relief that is shown and with the light chosen.
import { computed, effect, signal, untracked } from '@preact/signals';
import type { Backend, RunOptions } from '../../../jobs/backend';
import type { Job, Json, JsonObject, Report } from '../../../jobs/contract';
import { asJobError, findOperation } from '../../../jobs/contract';
import { LatestOnly } from '../../../jobs/latest_only';
import { readPly } from '../../../jobs/mesh_reader';
import { jsonEqual } from '../../../project/document';
import { download, safeFileName } from '../../../shared/session/download';
import { bytesOf } from '../../../shared/session/import_model';
import { readyWorker } from '../../../shared/session/services';
import type { ReliefSession, Shown } from '../relief_session';
import { lightOperation, lightParameters, setLight, srgbOf } from './light_values';

export interface LitRelief {
  readonly positions: Float32Array;
  readonly indices: Uint32Array;
  /** As a screen shows it, 0 to 1, per vertex. */
  readonly brightness: Float32Array;
  readonly report: Report;
  /** The relief that it is the light on. */
  readonly of: Shown;
}

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
    const catalog = this.#session.services.catalog.value;
    return catalog === null ? null : (findOperation(catalog, lightOperation) ?? null);
  });
  readonly #session: ReliefSession;
  readonly #latest = new LatestOnly<LightRequest>(
    (request, abort) => this.#run(request, abort),
    (running, next) => running.shown !== next.shown,
    (running, next) => running.shown === next.shown && jsonEqual(running.job.parameters, next.job.parameters),
  );

  constructor(session: ReliefSession) {
    this.#session = session;
  }

  startFollowing(): void {
    effect(() => {
      const request = this.open.value && this.#session.active.value ? this.#request(['light.ply']) : null;
      untracked(() => {
        if (request) this.#latest.request(request);
        else this.#latest.cancel();
      });
    });
  }

  values(): JsonObject {
    return this.#session.document.value.light;
  }

  preview(name: string, value: Json): void {
    const operation = this.operation.value;
    if (operation)
      this.#session.services.projects.do(setLight(operation, { [name]: value }, `light ${name}`));
  }

  /** Finished by a press: one step to undo. */
  set(name: string, value: Json): void {
    this.preview(name, value);
    this.#session.services.projects.commit();
  }

  /** Makes one of the other files in this light and hands it to the browser. */
  async save(name: string, label: string): Promise<void> {
    const request = this.#request([name]);
    if (request === null) return;
    const fileName = `${safeFileName(this.#session.title)}-${name}`;
    const bytes = await this.#session.busy(
      'exporting',
      label,
      async (options: RunOptions) => await bytesOf(await request.backend.run(request.job, options), name),
      (error) => (this.problem.value = error.message),
    );
    const declared = this.operation.value?.outputs.find((output) => output.name === name);
    if (bytes && declared) download(bytes, fileName, declared.media_type);
  }

  #request(outputs: readonly string[]): LightRequest | null {
    const session = this.#session;
    const operation = this.operation.value;
    const shown = session.shown.value;
    const { light } = session.document.value;
    const full = shown?.kind === 'full';
    const subject = full ? session.subject.value : session.model.previewSubject.value;
    if (operation === null || shown === null || subject === null || !session.fits.value) return null;
    const parameters = lightParameters(operation, shown.parameters, light, full ? null : shown);
    const job = { operation: lightOperation, parameters, inputs: subject.inputs, outputs };
    const backend = (full ? readyWorker(session.services) : null) ?? session.services.browser;
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
