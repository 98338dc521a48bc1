// SPDX-License-Identifier: GPL-3.0-or-later
// Painting on the model: the brush in the hand, what is painted now, and its way into the document. A stroke is a step to
// undo.
import type { ReadonlySignal } from '@preact/signals';
import { computed, effect, signal, untracked } from '@preact/signals';
import { asJobError } from '../../../jobs/contract';
import type { OpenedModel } from '../../../shared/session/opened_model';
import { vectorOf } from '../../../shared/session/report';
import type { RoomSession } from '../../../shared/session/room_session';
import type { Hit, Vec3 } from '../../../view';
import type { ReliefDocument } from '../relief_document';
import type { Shown } from '../shown';
import type { Paint, Painted, PaintKind } from './painted_values';
import {
  isPainted,
  paintedOf,
  paintedOfAttributes,
  paintingJson,
  paintOn,
  unpainted,
  without,
} from './painted_values';
import { paintingOf, setPainting } from './painting';
import { SurfaceBrush } from './surface_brush';

export const kindNames: Readonly<Record<PaintKind, string>> = {
  more: 'Matters more',
  less: 'Matters less',
  free: 'Free',
  on_base: 'On the base',
  own_thickness: 'Own thickness',
};

/** What can be filled without a hand. */
export type Fill = 'all' | 'part' | 'facing' | 'away' | 'outline';

/** What it needs of the room. */
type PaintRoom = RoomSession<ReliefDocument> & {
  readonly model: OpenedModel<ReliefDocument>;
  readonly shown: ReadonlySignal<Shown | null>;
  readonly drawnScale: ReadonlySignal<number>;
};

interface PaintedModel {
  readonly values: Painted;
  /** Counts strokes and dabs, of which the arrays do not tell. */
  readonly version: number;
}

export class PaintSession {
  readonly open = signal(false);
  /** Null erases. */
  readonly kind = signal<PaintKind | null>('on_base');
  readonly radius_mm = signal(6);
  readonly factor = signal(4);
  readonly thickness_mm = signal(10);
  /** Null without a model. */
  readonly painted = signal<PaintedModel | null>(null);
  readonly #room: PaintRoom;
  /** The mesh and the file that `painted` stands for; '' for no file. */
  #on: string | null = null;
  #file = '';
  #unsaved = 0;
  #loads = 0;
  #saving: Promise<void> = Promise.resolve();
  #stroke = false;
  readonly #brush = computed(() => {
    const mesh = this.#room.model.original.value?.mesh;
    return mesh ? new SurfaceBrush(mesh.positions, mesh.indices) : null;
  });

  constructor(room: PaintRoom) {
    this.#room = room;
  }

  startFollowing(): void {
    effect(() => {
      const original = this.#room.model.original.value;
      const document = this.#room.document.value;
      const { model } = document;
      const painting = paintingOf(document);
      untracked(() => {
        if (original === null || original.from !== model?.mesh.blob) {
          this.open.value = false;
          this.#on = null;
          this.#show(null, '');
        } else void this.#load(original, painting?.file?.blob ?? (painting ? '' : null));
      });
    });
  }

  /** `file`: its hash, '' where nothing is painted, null where nobody has painted yet: then the model's file counts. */
  async #load(
    original: NonNullable<PaintRoom['model']['original']['value']>,
    file: string | null,
  ): Promise<void> {
    const vertices = original.mesh.positions.length / 3;
    const known = this.#on === original.from;
    if (known && (this.#stroke || this.#unsaved > 0 || (file ?? '') === this.#file)) return;
    const load = ++this.#loads;
    this.#on = original.from;
    if (file === null) {
      const found = paintedOfAttributes(original.mesh.attributes, vertices);
      this.#show(found ?? unpainted(vertices), '');
      if (found) await this.#save('Open a painted model', false);
      return;
    }
    if (file === '') {
      this.#show(unpainted(vertices), '');
      return;
    }
    try {
      const bytes = await this.#room.services.projects.blobs.read(file);
      if (load !== this.#loads) return;
      this.#show(paintedOf(new TextDecoder().decode(bytes), vertices) ?? unpainted(vertices), file);
    } catch (thrown) {
      if (load !== this.#loads) return;
      this.#show(unpainted(vertices), file);
      const { message } = asJobError(thrown);
      this.#room.problem.value = { kind: 'file', title: 'The painting is missing', message };
    }
  }

  #show(values: Painted | null, file: string): void {
    this.#file = file;
    this.painted.value = values && { values, version: (this.painted.peek()?.version ?? 0) + 1 };
  }

  #changed(values: Painted): void {
    this.painted.value = { values, version: (this.painted.peek()?.version ?? 0) + 1 };
  }

  get #paint(): Paint {
    const [kind, factor, thickness_mm] = [this.kind, this.factor, this.thickness_mm].map((s) => s.peek());
    return { kind, factor, thickness_mm } as Paint;
  }

  /** Where the pointer is; `endStroke` keeps what was painted. */
  dab(hit: Hit): void {
    const [brush, painted] = [this.#brush.peek(), this.painted.peek()];
    if (brush === null || painted === null || hit.part !== 'original' || hit.triangle < 0) return;
    const scale = this.#room.drawnScale.peek();
    const centre = hit.positionMm.map((x) => x / scale) as unknown as Vec3;
    this.#stroke = true;
    paintOn(painted.values, brush.within(hit.triangle, centre, this.radius_mm.peek() / scale), this.#paint);
    this.#changed(painted.values);
  }

  async endStroke(): Promise<void> {
    if (!this.#stroke) return;
    this.#stroke = false;
    await this.#save(this.#label);
  }

  get #label(): string {
    const kind = this.kind.peek();
    return kind === null ? 'Erase paint' : `Paint “${kindNames[kind]}”`;
  }

  /** `hit`: in the middle of the view, for the part there. */
  async fill(what: Fill, hit: Hit | null): Promise<void> {
    const [brush, painted] = [this.#brush.peek(), this.painted.peek()];
    if (brush === null || painted === null) return;
    const vertices =
      what === 'all'
        ? Array.from({ length: brush.vertices }, (_, v) => v)
        : what !== 'part'
          ? brush.side(what, this.#towardsEye())
          : hit?.part === 'original' && hit.triangle >= 0
            ? brush.part(hit.triangle)
            : [];
    if (vertices.length === 0) return;
    paintOn(painted.values, vertices, this.#paint);
    this.#changed(painted.values);
    await this.#save(this.#label);
  }

  /** In the model's own units, from the viewpoint that the relief is made for. */
  #towardsEye(): (at: Vec3) => Vec3 {
    const report = this.#room.shown.peek()?.report ?? {};
    const direction = vectorOf(report, 'direction') ?? [0, 0, -1];
    const eye = vectorOf(report, 'viewpoint_mm');
    const scale = this.#room.drawnScale.peek();
    if (eye === null || typeof report['distance_mm'] !== 'number')
      return () => direction.map((x) => -x) as unknown as Vec3;
    return (at) => at.map((x, k) => (eye[k as 0] ?? 0) / scale - x) as unknown as Vec3;
  }

  async clear(kind: PaintKind): Promise<void> {
    const painted = this.painted.peek();
    if (painted === null) return;
    this.#changed(without(painted.values, kind));
    await this.#save(`Clear “${kindNames[kind]}”`);
  }

  async clearAll(): Promise<void> {
    const painted = this.painted.peek();
    if (painted === null) return;
    this.#changed(unpainted(painted.values.region.length));
    await this.#save('Clear the painting');
  }

  /** The file is kept before the document speaks of it, one after the other. */
  #save(label: string, recorded = true): Promise<void> {
    const painted = this.painted.peek();
    const original = this.#room.model.original.peek();
    if (painted === null || original === null) return Promise.resolve();
    const { attributes } = original.mesh;
    // A painted model whose painting was cleared needs a file that says so.
    const ofFile = paintedOfAttributes(attributes, 0) !== null;
    const text = isPainted(painted.values) || ofFile ? paintingJson(painted.values) : null;
    const change = this.#room.changesHere();
    ++this.#unsaved;
    const save = async () => {
      const bytes = text === null ? null : new TextEncoder().encode(text);
      const file = bytes && (await this.#room.keep(bytes, 'application/json'));
      // What is shown is newer than any file on its way.
      ++this.#loads;
      this.#file = file?.blob ?? '';
      if (this.#room.document.peek().model?.mesh.blob !== original.from) return;
      change(setPainting({ on: original.from, file }, label, recorded));
      this.#room.services.projects.commit();
    };
    this.#saving = this.#saving
      .then(save)
      .catch((thrown: unknown) => {
        const error = asJobError(thrown);
        const title = 'Could not keep the painting';
        if (error.code !== 'cancelled')
          this.#room.problem.value = { kind: 'file', title, message: error.message };
      })
      .finally(() => --this.#unsaved);
    return this.#saving;
  }
}
