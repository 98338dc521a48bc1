// SPDX-License-Identifier: GPL-3.0-or-later
// The model simply squashed into the same thickness, to see beside the relief: made of what is shown, while it is
// asked for.
import type { ReadonlySignal } from '@preact/signals';
import { effect, signal, untracked } from '@preact/signals';
import type { Backend } from '../../../jobs/backend';
import type { Job } from '../../../jobs/contract';
import { asJobError } from '../../../jobs/contract';
import { LatestOnly } from '../../../jobs/latest_only';
import { readPly } from '../../../jobs/mesh_reader';
import type { Subject } from '../../../shared/session/craft_document';
import { bytesOf } from '../../../shared/session/import_model';
import type { RoomSession } from '../../../shared/session/room_session';
import { readyWorker } from '../../../shared/session/services';
import type { MeshData } from '../../../view';
import type { ReliefDocument } from '../relief_document';
import type { Shown } from '../shown';

export interface SquashedModel {
  readonly mesh: MeshData;
  /** The relief that it is as thick as. */
  readonly of: Shown;
}

/** What it needs of the room. */
type SquashedRoom = Pick<RoomSession<ReliefDocument>, 'services' | 'active' | 'subject'> & {
  readonly shown: ReadonlySignal<Shown | null>;
  readonly fits: ReadonlySignal<boolean>;
  readonly model: { readonly previewSubject: ReadonlySignal<Subject | null> };
};

interface SquashedRequest {
  readonly shown: Shown;
  readonly job: Job;
  readonly backend: Backend;
}

export class SquashedRelief {
  /** It is to stand beside the relief. */
  readonly wanted = signal(false);
  /** The view shows both sides: only then is it kept up to date. */
  readonly open = signal(false);
  readonly made = signal<SquashedModel | null>(null);
  readonly running = signal(false);
  readonly problem = signal<string | null>(null);
  readonly #room: SquashedRoom;
  readonly #latest = new LatestOnly<SquashedRequest>(
    (request, abort) => this.#run(request, abort),
    (running, next) => running.shown !== next.shown,
    (running, next) => running.shown === next.shown,
  );

  constructor(room: SquashedRoom) {
    this.#room = room;
  }

  startFollowing(): void {
    effect(() => {
      const request = this.open.value && this.#room.active.value ? this.#request() : null;
      untracked(() => {
        if (request === null) this.#latest.cancel();
        else if (request.shown !== this.made.value?.of) this.#latest.request(request);
      });
    });
  }

  #request(): SquashedRequest | null {
    const room = this.#room;
    const shown = room.shown.value;
    const full = shown?.kind === 'full';
    const subject = full ? room.subject.value : room.model.previewSubject.value;
    if (shown === null || subject === null || !room.fits.value) return null;
    const parameters = { ...shown.parameters, appearance: 'squashed', compare_pictures: false };
    const job = { operation: 'relief', parameters, inputs: subject.inputs, outputs: ['relief.ply'] };
    const backend = (full ? readyWorker(room.services) : null) ?? room.services.browser;
    return { shown, job, backend };
  }

  async #run({ shown, job, backend }: SquashedRequest, signal: AbortSignal): Promise<void> {
    this.running.value = true;
    try {
      const result = await backend.run(job, { signal });
      const { positions, indices } = await readPly(await bytesOf(result, 'relief.ply'));
      if (signal.aborted) return;
      this.problem.value = null;
      this.made.value = { mesh: { positions, indices }, of: shown };
    } catch (thrown) {
      const error = asJobError(thrown);
      if (error.code === 'cancelled' || signal.aborted) return;
      this.made.value = null; // the last one is of another relief
      this.problem.value = error.message;
    } finally {
      this.running.value = false;
    }
  }
}
