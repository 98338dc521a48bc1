// SPDX-License-Identifier: GPL-3.0-or-later
// A base from a file in the hand: previews follow while it is moved.
import { computed, signal } from '@preact/signals';
import type { Viewport } from '../../../view';
import { along } from '../../../view/vector';
import type { Grip, GripElements, Place } from '../handles/grips';
import { placeAround } from '../handles/grips';
import type { Mover } from '../handles/handles';
import { plateAxesOf } from '../meshes';
import type { ReliefSession } from '../relief_session';
import type { BasePlace, PlateAxes } from './base_place';
import { angleBetween, byKey, onPlane, originOf, turnedBy } from './base_place';

/** What of a base may lie under the handles: their distance from its origin. */
const halfSize_mm = 30;

export class BaseMover implements Mover {
  readonly grips = ['move', 'depth', 'turn'] as const;
  readonly grip = signal<Grip | null>(null);
  readonly #session: ReliefSession;
  #from: { readonly place: BasePlace; readonly px: Place; readonly middlePx: Place } | null = null;

  constructor(session: ReliefSession) {
    this.#session = session;
  }

  readonly name = computed(() => this.#session.document.value.base?.file_name ?? '');

  readonly place = computed((): BasePlace | null => {
    if (this.#session.document.value.base === null) return null;
    const value = (name: string) => Number(this.#session.value(name) ?? 0);
    return {
      x_mm: value('base_mesh_x_mm'),
      y_mm: value('base_mesh_y_mm'),
      z_mm: value('base_mesh_z_mm'),
      turn_deg: value('base_mesh_turn_deg'),
    };
  });

  readonly #axes = computed((): PlateAxes | null => {
    const shown = this.#session.shown.value;
    return shown && plateAxesOf(shown.report);
  });

  /** Where the base's origin is seen, and how many pixels a millimetre covers there. */
  #seen(viewport: Viewport): { readonly middlePx: Place; readonly pixelsAMm: number } | null {
    const [place, axes] = [this.place.peek(), this.#axes.peek()];
    if (place === null || axes === null) return null;
    const origin = originOf(place, axes);
    const [middle, beside] = [viewport.project(origin), viewport.project(along(origin, axes.right, 1))];
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
    const { place } = from;
    if (grip === 'turn') this.#put(turnedBy(place, angleBetween(from.middlePx, from.px, px), free));
    else if (grip === 'depth') {
      const pixelsAMm = this.#seen(viewport)?.pixelsAMm ?? 0;
      if (pixelsAMm > 0) this.#put({ ...place, z_mm: place.z_mm + (px[1] - from.px[1]) / pixelsAMm });
    } else {
      const [before, now] = [from.px, px].map((at) =>
        onPlane(viewport.rayThrough(at[0], at[1]), axes, place.z_mm),
      );
      if (before && now)
        this.#put({
          ...place,
          x_mm: place.x_mm + now[0] - before[0],
          y_mm: place.y_mm + now[1] - before[1],
        });
    }
  }

  key(_: Viewport, grip: Grip, key: string, fine: boolean): boolean {
    const place = this.place.peek();
    const next = place && byKey(place, grip, key, fine);
    if (!next) return false;
    this.grip.value = grip;
    this.#put(next);
    return true;
  }

  end(): void {
    this.#from = null;
    if (this.grip.peek() === null) return;
    this.grip.value = null;
    this.#session.services.projects.commit();
  }

  #put(place: BasePlace): void {
    const values = Object.fromEntries(
      Object.entries(place).map(([name, value]) => [
        `base_mesh_${name}`,
        this.#within(`base_mesh_${name}`, value),
      ]),
    );
    this.#session.setParameters(
      values,
      this.grip.peek() === 'turn' ? 'Turn the base' : 'Move the base',
      'base',
    );
  }

  /** Tenths are finer than anybody drags. */
  #within(name: string, value: number): number {
    const { minimum = -Infinity, maximum = Infinity } =
      this.#session.operation.peek()?.parameters.properties[name] ?? {};
    return Number(Math.min(maximum, Math.max(minimum, value)).toFixed(1)) + 0;
  }

  /** `there`: whether the relief on its base is what is looked at. */
  placeHandles(viewport: Viewport, elements: GripElements, there: boolean): void {
    const seen = there ? this.#seen(viewport) : null;
    placeAround(elements, this.grips, seen && seen.middlePx, halfSize_mm * (seen?.pixelsAMm ?? 0));
  }
}
