// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps the pieces of a relief on stairs, strips or a base of several parts in step with the relief that is shown, while they are looked at.
import type { ReadonlySignal } from '@preact/signals';
import { computed, effect, signal, untracked } from '@preact/signals';
import type { Backend } from '../../../jobs/backend';
import type { Job, Json, Report } from '../../../jobs/contract';
import { asJobError } from '../../../jobs/contract';
import { LatestOnly } from '../../../jobs/latest_only';
import { readNodes } from '../../../jobs/mesh_reader';
import { inForce } from '../../../shared/session/craft_document';
import type { Subject } from '../../../shared/session/craft_document';
import { bytesOf } from '../../../shared/session/import_model';
import type { RoomSession } from '../../../shared/session/room_session';
import { readyWorker } from '../../../shared/session/services';
import type { ReliefDocument } from '../relief_document';
import type { Shown } from '../shown';
import type { Piece } from './piece_meshes';
import { pieceOf } from './piece_meshes';

/** What it needs of the room. */
type PiecesRoom = Pick<
  RoomSession<ReliefDocument>,
  'services' | 'document' | 'active' | 'subject' | 'operation'
> & {
  readonly shown: ReadonlySignal<Shown | null>;
  readonly fits: ReadonlySignal<boolean>;
  readonly model: { readonly previewSubject: ReadonlySignal<Subject | null> };
};

export interface MadePieces {
  readonly pieces: readonly Piece[];
  readonly report: Report;
  /** The relief that they are cut of. */
  readonly of: Shown;
}

interface PiecesRequest {
  readonly shown: Shown;
  readonly job: Job;
  readonly backend: Backend;
}

/** Of the relief's width: pieces that are only looked at need no finer detail. */
const pixelsOfPicture = 200;
const file = 'pieces.glb';

const basesInPieces: readonly Json[] = ['stairs', 'strips'];

export class ReliefPieces {
  /** The view shows them: only then are they made. */
  readonly open = signal(false);
  readonly made = signal<MadePieces | null>(null);
  readonly running = signal(false);
  readonly problem = signal<string | null>(null);
  /** How far they are pulled apart, 0 to 1. */
  readonly apart = signal(0);
  /** The base that is chosen has steps, strips or several parts. */
  readonly possible = computed(() => {
    const { parameters, base } = this.#room.document.value;
    const operation = this.#room.operation.value;
    // Of a file only the relief that is made on it says how many parts it has.
    if (base !== null) return Number(this.#room.shown.value?.report['base_parts'] ?? 1) > 1;
    return operation !== null && basesInPieces.includes(inForce(operation, parameters, 'base'));
  });
  readonly #room: PiecesRoom;
  readonly #latest = new LatestOnly<PiecesRequest>(
    (request, abort) => this.#run(request, abort),
    (running, next) => running.shown !== next.shown,
    (running, next) => running.shown === next.shown,
  );

  constructor(room: PiecesRoom) {
    this.#room = room;
  }

  startFollowing(): void {
    effect(() => {
      const request =
        this.open.value && this.#room.active.value && this.possible.value ? this.#request() : null;
      untracked(() => {
        if (request) this.#latest.request(request);
        else this.#latest.cancel();
      });
    });
  }

  #request(): PiecesRequest | null {
    const room = this.#room;
    const operation = room.operation.value;
    const shown = room.shown.value;
    const full = shown?.kind === 'full';
    const subject = full ? room.subject.value : room.model.previewSubject.value;
    if (operation === null || shown === null || subject === null || !room.fits.value) return null;
    if (this.made.peek()?.of === shown) return null;
    const value = (name: string) => Number(inForce(operation, shown.parameters, name));
    const pixel_mm = Math.max(value('pixel_mm'), value('width_mm') / pixelsOfPicture);
    const job = {
      operation: operation.name,
      parameters: { ...shown.parameters, pixel_mm },
      inputs: subject.inputs,
      outputs: [file],
    };
    return { shown, job, backend: (full ? readyWorker(room.services) : null) ?? room.services.browser };
  }

  async #run({ shown, job, backend }: PiecesRequest, signal: AbortSignal): Promise<void> {
    this.running.value = true;
    try {
      const result = await backend.run(job, { signal });
      const nodes = await readNodes(await bytesOf(result, file));
      if (signal.aborted) return;
      this.problem.value = null;
      this.made.value = { pieces: nodes.map(pieceOf), report: result.report, of: shown };
    } catch (thrown) {
      const error = asJobError(thrown);
      if (error.code !== 'cancelled' && !signal.aborted) this.problem.value = error.message;
    } finally {
      this.running.value = false;
    }
  }
}
