// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps what is shown in step with what is asked for: a full result where one was made with the same model and
// parameters, else a coarse preview, solved anew at every change.
import { effect, signal, untracked } from '@preact/signals';
import type { JsonObject, Report } from '../../jobs/contract';
import { asJobError } from '../../jobs/contract';
import { LatestOnly } from '../../jobs/latest_only';
import { jsonEqual } from '../../project/document';
import type { CraftDocument, CraftResult, Subject } from './craft_document';
import type { ModelRoom } from './opened_model';

export interface ShownWork {
  readonly kind: 'preview' | 'full';
  readonly report: Report;
  /** What it was asked for with; what is not here has its default. */
  readonly parameters: JsonObject;
  /** The key of what it was made from. */
  readonly from: string;
}

export interface PreviewRequest {
  readonly subject: Subject;
  readonly parameters: JsonObject;
}

export interface PreviewRules<S extends ShownWork> {
  /** The outputs that a full result is shown by. */
  readonly shownOutputs: readonly string[];
  readonly failedTitle: string;
  readonly make: (request: PreviewRequest, signal: AbortSignal) => Promise<S>;
  readonly read: (result: CraftResult) => Promise<S>;
  /** A running preview older than this is given up for a newer one. Without it, only one of another model is: of the same model it
   *  shows the way a slider goes. */
  readonly patience_ms?: number;
  /** Shows the next work with what goes along with it; without it, `show` alone. */
  readonly present?: (next: S, show: () => void) => void;
}

export class Previews<D extends CraftDocument, S extends ShownWork> {
  readonly shown = signal<S | null>(null);
  readonly running = signal(false);
  /** What the last preview took. */
  readonly seconds = signal<number | null>(null);
  readonly #room: ModelRoom<D>;
  readonly #rules: PreviewRules<S>;
  #start_ms = 0;
  readonly #latest = new LatestOnly<PreviewRequest>(
    (request, abort) => this.#run(request, abort),
    (running, next) => this.#isObsolete(running, next),
    (running, next) =>
      running.subject.key === next.subject.key && jsonEqual(running.parameters, next.parameters),
  );

  constructor(room: ModelRoom<D>, rules: PreviewRules<S>) {
    this.#room = room;
    this.#rules = rules;
  }

  /** To be called once the room is set up. */
  startFollowing(): void {
    const room = this.#room;
    effect(() => {
      const from = room.document.value.model?.mesh.blob ?? null;
      if (from === null) this.shown.value = null;
      if (room.active.value) void room.model.load(from);
    });
    effect(() => this.follow());
  }

  cancel(): void {
    this.#latest.cancel();
  }

  /** Whenever model or parameters change: show the full result made with them, or preview. */
  follow(): void {
    const room = this.#room;
    const parameters = room.asked.value;
    const subject = room.model.previewSubject.value;
    if (!room.active.value || subject === null || room.operation.value === null) return;
    const found = room.result.value;
    room.cancelOutdatedSolve();
    untracked(() => {
      if (found && this.#rules.shownOutputs.every((name) => found.outputs[name]))
        void this.#showResult(found);
      else if (this.#shows('preview', subject.key, parameters)) {
        // Back to what is seen already, as after an undo: what was wrong in between no longer is.
        this.#latest.cancel();
        this.#room.fieldErrors.value = {};
      } else this.#latest.request({ subject, parameters });
    });
  }

  #isObsolete(running: PreviewRequest, next: PreviewRequest): boolean {
    const { patience_ms = Infinity } = this.#rules;
    return running.subject.key !== next.subject.key || performance.now() - this.#start_ms > patience_ms;
  }

  #shows(kind: S['kind'], from: string, parameters: JsonObject): boolean {
    const shown = this.shown.value;
    return shown?.kind === kind && shown.from === from && jsonEqual(shown.parameters, parameters);
  }

  async #showResult(result: CraftResult): Promise<void> {
    this.#latest.cancel();
    this.#room.fieldErrors.value = {};
    if (this.#shows('full', result.mesh, result.parameters)) return;
    try {
      const shown = await this.#rules.read(result);
      if (this.#room.result.value?.id === result.id) this.#show(shown);
    } catch {
      this.#room.lose(result); // its bytes were not kept; a preview follows, and it can be made again
    }
  }

  #show(next: S): void {
    const show = () => {
      this.#room.fieldErrors.value = {};
      this.shown.value = next;
    };
    if (this.#rules.present) this.#rules.present(next, show);
    else show();
  }

  async #run(request: PreviewRequest, abort: AbortSignal): Promise<void> {
    const room = this.#room;
    const start_ms = performance.now();
    this.running.value = true;
    this.#start_ms = start_ms;
    try {
      const shown = await this.#rules.make(request, abort);
      this.seconds.value = (performance.now() - start_ms) / 1000;
      if (abort.aborted || room.model.previewSubject.value?.key !== request.subject.key) return;
      if (room.result.value === null) this.#show(shown);
    } catch (thrown) {
      const error = asJobError(thrown);
      if (error.code === 'cancelled' || abort.aborted) return;
      // What was made of another model says nothing of the one that is refused.
      const of = [request.subject.key, room.subject.value?.key];
      if (!of.includes(this.shown.value?.from)) this.shown.value = null;
      room.report(error, this.#rules.failedTitle);
    } finally {
      this.running.value = false;
    }
  }
}

/** A room that previews as one goes and solves in full when asked. */
export type PreviewingRoom<D extends CraftDocument, S extends ShownWork> = ModelRoom<D> & {
  readonly previews: Previews<D, S>;
};
