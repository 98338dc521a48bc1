// SPDX-License-Identifier: GPL-3.0-or-later
// One model of a group in the hand: drawn where it is held, and made when it is put down.
import { computed, signal } from '@preact/signals';
import type { PlacedModel } from '../../../shared/session/craft_document';
import { scaled } from '../../../shared/panels/shaded_mesh';
import type { Viewport } from '../../../view';
import type { ReliefSession } from '../relief_session';
import type { Grip, GripElements, Place } from '../handles/grips';
import { placeAround } from '../handles/grips';
import type { Mover } from '../handles/handles';
import { byKey, dragged } from './hold';
import type { Vector } from '../../../shared/geometry/rotation';
import type { ViewAxes } from './placement';
import { movedVertices, viewAxes } from './placement';

const labels: Readonly<Record<Grip, string>> = {
  move: 'Move',
  depth: 'Move',
  turn: 'Turn',
  size: 'Change the size of',
};

export class GroupMover implements Mover {
  readonly grips = ['move', 'depth', 'turn', 'size'] as const;
  readonly grip = signal<Grip | null>(null);
  readonly #session: ReliefSession;
  #from: {
    readonly model: PlacedModel;
    readonly px: Place;
    readonly middlePx: Place;
    readonly mmAPixel: number;
  } | null = null;

  constructor(session: ReliefSession) {
    this.#session = session;
  }

  /** As it stands now, in the hand or not. */
  readonly model = computed(() => {
    const { group } = this.#session;
    return group.held.value ?? group.models.value?.[group.chosen.value] ?? null;
  });

  readonly name = computed(() => this.model.value?.name ?? '');

  #axes(viewport: Viewport): ViewAxes {
    const { direction, up } = viewport.getCameraAsViewpoint();
    return viewAxes(direction, up);
  }

  /** A place of the scene as the picture has it: drawn at the size of the relief. */
  #drawn(place: Vector): Vector {
    const scale = this.#session.drawnScale.peek();
    return [place[0] * scale, place[1] * scale, place[2] * scale];
  }

  /** Where the chosen model's middle is seen, and how many millimetres of the scene a pixel covers there. */
  #seen(
    viewport: Viewport,
    model: PlacedModel,
  ): { readonly middlePx: Place; readonly mmAPixel: number } | null {
    const { right } = this.#axes(viewport);
    const beside: Vector = [model.at_mm[0] + right[0], model.at_mm[1] + right[1], model.at_mm[2] + right[2]];
    const middle = viewport.project(this.#drawn(model.at_mm));
    const other = viewport.project(this.#drawn(beside));
    if (middle === null || other === null) return null;
    const pixels = Math.hypot(other.xPx - middle.xPx, other.yPx - middle.yPx);
    return pixels > 0 ? { middlePx: [middle.xPx, middle.yPx], mmAPixel: 1 / pixels } : null;
  }

  begin(viewport: Viewport, grip: Grip, px: Place): void {
    const model = this.model.peek();
    const seen = model && this.#seen(viewport, model);
    if (model === null || seen === null) return;
    this.#from = { model, px, ...seen };
    this.grip.value = grip;
  }

  drag(viewport: Viewport, px: Place, free: boolean): void {
    const grip = this.grip.peek();
    if (this.#from === null || grip === null) return;
    const { model, px: fromPx, middlePx, mmAPixel } = this.#from;
    this.#hold(
      viewport,
      dragged(model, grip, { fromPx, toPx: px, middlePx, mmAPixel }, this.#axes(viewport), free),
    );
  }

  key(viewport: Viewport, grip: Grip, key: string, fine: boolean): boolean {
    const model = this.model.peek();
    const next = model && byKey(model, grip, key, fine, this.#axes(viewport));
    if (!next) return false;
    this.grip.value = grip;
    this.#hold(viewport, next);
    return true;
  }

  /** Puts it down. */
  end(): void {
    const grip = this.grip.peek();
    this.#from = null;
    if (grip === null) return;
    this.grip.value = null;
    const { group } = this.#session;
    const held = group.held.peek();
    if (held) group.release(`${labels[grip]} ${held.name}`);
  }

  #hold(viewport: Viewport, model: PlacedModel): void {
    const { group, model: opened } = this.#session;
    group.held.value = model;
    const original = opened.original.peek();
    const source = this.#session.document.peek().model?.source;
    if (original === null || source?.kind !== 'group') return;
    const positions = original.mesh.positions.slice();
    for (const [i, { begin, end }] of (group.parts.peek() ?? []).entries()) {
      const before = source.models[i];
      // What was put down a moment ago is on its way.
      const now = i === group.chosen.peek() ? model : group.models.peek()?.[i];
      if (before === undefined || now === undefined || now === before || 3 * end > positions.length) continue;
      const own = positions.subarray(3 * begin, 3 * end);
      own.set(movedVertices(own.slice(), before, now));
    }
    viewport.updateOriginal(scaled(positions, this.#session.drawnScale.peek()));
  }

  /** Puts the handles around the chosen model; `there`: whether the models are what is looked at. */
  placeHandles(viewport: Viewport, elements: GripElements, there: boolean): void {
    const model = there ? this.model.peek() : null;
    const seen = model && this.#seen(viewport, model);
    placeAround(
      elements,
      this.grips,
      seen && seen.middlePx,
      model && seen ? (0.5 * model.size_mm) / seen.mmAPixel : 0,
    );
  }

  /** The model of the group that has this triangle is the one to change. */
  choose(triangle: number): void {
    const { group, model } = this.#session;
    const vertex = model.original.peek()?.mesh.indices[3 * triangle];
    const found =
      vertex === undefined
        ? -1
        : (group.parts.peek()?.findIndex(({ begin, end }) => vertex >= begin && vertex < end) ?? -1);
    if (found >= 0) group.chosen.value = found;
  }
}
