// SPDX-License-Identifier: GPL-3.0-or-later
// What moves on the plate of a relief, in the hand: held by handles around its middle, while previews follow.
import type { ReadonlySignal } from '@preact/signals';
import { computed, signal } from '@preact/signals';
import type { Vec3, Viewport } from '../../../view';
import { along } from '../../../view/vector';
import type { Grip, GripElements, Place } from '../handles/grips';
import { placeAround } from '../handles/grips';
import type { Mover } from '../handles/handles';
import { plateAxesOf } from '../meshes';
import type { ReliefSession } from '../relief_session';
import type { PlateAxes } from './base_place';
import { angleBetween, turnedBy } from './base_place';

/** What may lie under the handles: their distance from the middle. */
const halfSize_mm = 30;

export abstract class PlateMover<P extends { readonly turn_deg: number }> implements Mover {
  abstract readonly grips: readonly Grip[];
  abstract readonly name: ReadonlySignal<string>;
  /** Null where nothing can be moved. */
  abstract readonly place: ReadonlySignal<P | null>;
  readonly grip = signal<Grip | null>(null);
  protected readonly session: ReliefSession;
  #from: { readonly place: P; readonly px: Place; readonly middlePx: Place } | null = null;

  constructor(session: ReliefSession) {
    this.session = session;
  }

  readonly #axes = computed((): PlateAxes | null => {
    const shown = this.session.shown.value;
    return shown && plateAxesOf(shown.report);
  });

  /** In the scene. */
  protected abstract middleOf(place: P, axes: PlateAxes): Vec3;
  /** Null for keys that do nothing here. */
  protected abstract byKey(place: P, grip: Grip, key: string, fine: boolean): P | null;
  /** Where a handle other than that for turning is dragged from one place in the picture to another; null where it
   *  cannot be found. */
  protected abstract dragged(
    place: P,
    grip: Grip,
    ways: { viewport: Viewport; axes: PlateAxes; from: Place; to: Place; pixelsAMm: number },
  ): P | null;
  protected abstract valuesOf(place: P): Record<string, number>;
  /** Whether a handle has something to move at all. */
  protected moves(_place: P, _grip: Grip): boolean {
    return true;
  }

  /** Where the middle is seen, and how many pixels a millimetre covers there. */
  #seen(viewport: Viewport): { readonly middlePx: Place; readonly pixelsAMm: number } | null {
    const [place, axes] = [this.place.peek(), this.#axes.peek()];
    if (place === null || axes === null) return null;
    const at = this.middleOf(place, axes);
    const [middle, beside] = [viewport.project(at), viewport.project(along(at, axes.right, 1))];
    if (middle === null || beside === null) return null;
    const pixelsAMm = Math.hypot(beside.xPx - middle.xPx, beside.yPx - middle.yPx);
    return { middlePx: [middle.xPx, middle.yPx], pixelsAMm };
  }

  begin(viewport: Viewport, grip: Grip, px: Place): void {
    const place = this.place.peek();
    const seen = this.#seen(viewport);
    if (place === null || seen === null) return;
    this.#from = { place, px, middlePx: seen.middlePx };
    this.grip.value = grip;
  }

  drag(viewport: Viewport, px: Place, free: boolean): void {
    const [grip, axes, from] = [this.grip.peek(), this.#axes.peek(), this.#from];
    if (grip === null || axes === null || from === null) return;
    const pixelsAMm = this.#seen(viewport)?.pixelsAMm ?? 0;
    const next =
      grip === 'turn'
        ? turnedBy(from.place, angleBetween(from.middlePx, from.px, px), free)
        : this.dragged(from.place, grip, { viewport, axes, from: from.px, to: px, pixelsAMm });
    if (next) this.#put(next);
  }

  key(_: Viewport, grip: Grip, key: string, fine: boolean): boolean {
    const place = this.place.peek();
    const next = place && this.byKey(place, grip, key, fine);
    if (!next) return false;
    this.grip.value = grip;
    this.#put(next);
    return true;
  }

  end(): void {
    this.#from = null;
    if (this.grip.peek() === null) return;
    this.grip.value = null;
    this.session.services.projects.commit();
  }

  #put(place: P): void {
    this.session.setParameters(
      this.valuesOf(place),
      this.grip.peek() === 'turn' ? 'Turn the base' : 'Move the base',
      'base',
    );
  }

  /** `there`: whether the relief on its base is what is looked at. */
  placeHandles(viewport: Viewport, elements: GripElements, there: boolean): void {
    const seen = there ? this.#seen(viewport) : null;
    const place = this.place.peek();
    for (const grip of this.grips) {
      const middlePx = seen && place && this.moves(place, grip) ? seen.middlePx : null;
      placeAround(elements, [grip], middlePx, halfSize_mm * (seen?.pixelsAMm ?? 0));
    }
  }
}

/** Tenths are finer than anybody drags. */
export const tenthsWithin = (value: number, minimum: number, maximum: number): number =>
  Number(Math.min(maximum, Math.max(minimum, value)).toFixed(1)) + 0;
