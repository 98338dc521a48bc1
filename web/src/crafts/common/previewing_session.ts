// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps what is shown in step with what is asked for: a full result where one was made with the same model and
// parameters, else a coarse preview, solved anew at every change.
import { computed, effect, signal, untracked } from '@preact/signals';
import type { JsonObject, Report } from '../../jobs/contract';
import { asJobError } from '../../jobs/contract';
import { LatestOnly } from '../../jobs/latest_only';
import { jsonEqual } from '../../project/document';
import type { CraftDocument, CraftModel, CraftResult, Subject } from './craft_document';
import { subjectOf } from './craft_document';
import { CraftSession } from './craft_session';

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

export abstract class PreviewingSession<
  D extends CraftDocument,
  S extends ShownWork,
> extends CraftSession<D> {
  readonly shown = signal<S | null>(null);
  readonly previewing = signal(false);
  readonly previewSeconds = signal<number | null>(null);
  /** Of the wanted outputs, those that a full result is shown by. */
  protected abstract readonly shownOutputs: readonly string[];
  protected abstract readonly previewFailedTitle: string;
  protected abstract makePreview(request: PreviewRequest, signal: AbortSignal): Promise<S>;
  protected abstract readResult(result: CraftResult): Promise<S>;
  /** A running preview of another model is of no use; of the same model it shows the way a slider goes. */
  protected isObsolete(running: PreviewRequest, next: PreviewRequest): boolean {
    return running.subject.key !== next.subject.key;
  }
  readonly #preview = new LatestOnly<PreviewRequest>(
    (request, abort) => this.#runPreview(request, abort),
    (running, next) => this.isObsolete(running, next),
    (running, next) =>
      running.subject.key === next.subject.key && jsonEqual(running.parameters, next.parameters),
  );

  /** To be called once everything is set up. */
  protected startFollowing(): void {
    this.result = this.unlessLost(this.result);
    effect(() => {
      const from = this.document.value.model?.mesh.blob ?? null;
      if (from === null) this.shown.value = null;
      if (this.active.value) void this.loadOriginal(from);
    });
    effect(() => this.follow());
  }

  /** What previews are made of. */
  readonly previewSubject = computed(() => {
    const { model } = this.document.value;
    return model && this.#previewSubject(model);
  });

  cancelPreview(): void {
    this.#preview.cancel();
  }

  /** Whenever model or parameters change: show the full result made with them, or preview. */
  protected follow(): void {
    const { model } = this.document.value;
    const parameters = this.asked.value;
    const subject = model && this.#previewSubject(model);
    if (!this.active.value || subject === null || this.operation.value === null) return;
    const found = this.result.value;
    this.cancelOutdatedSolve();
    untracked(() => {
      if (found && this.shownOutputs.every((name) => found.outputs[name])) void this.#showResult(found);
      else if (this.#shows('preview', subject.key, parameters)) {
        // Back to what is seen already, as after an undo: what was wrong in between no longer is.
        this.#preview.cancel();
        this.fieldErrors.value = {};
      } else this.#preview.request({ subject, parameters });
    });
  }

  #previewSubject(model: CraftModel): Subject {
    return subjectOf(model.preview, this.meshInputName, this.furtherInputs.value);
  }

  #shows(kind: S['kind'], from: string, parameters: JsonObject): boolean {
    const shown = this.shown.value;
    return shown?.kind === kind && shown.from === from && jsonEqual(shown.parameters, parameters);
  }

  async #showResult(result: CraftResult): Promise<void> {
    this.#preview.cancel();
    this.fieldErrors.value = {};
    if (this.#shows('full', result.mesh, result.parameters)) return;
    try {
      const shown = await this.readResult(result);
      if (this.result.value?.id === result.id) this.show(shown);
    } catch {
      this.lose(result); // its bytes were not kept; a preview follows, and it can be made again
    }
  }

  protected show(shown: S): void {
    this.fieldErrors.value = {};
    this.shown.value = shown;
  }

  async #runPreview(request: PreviewRequest, abort: AbortSignal): Promise<void> {
    this.previewing.value = true;
    const start = performance.now();
    try {
      const shown = await this.makePreview(request, abort);
      this.previewSeconds.value = (performance.now() - start) / 1000;
      const { model } = this.document.value;
      if (abort.aborted || model === null || this.#previewSubject(model).key !== request.subject.key) return;
      if (this.result.value === null) this.show(shown);
    } catch (thrown) {
      const error = asJobError(thrown);
      if (error.code === 'cancelled' || abort.aborted) return;
      // What was made of another model says nothing of the one that is refused.
      const of = [request.subject.key, this.subject.value?.key];
      if (!of.includes(this.shown.value?.from)) this.shown.value = null;
      this.report(error, this.previewFailedTitle);
    } finally {
      this.previewing.value = false;
    }
  }
}
