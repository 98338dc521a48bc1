// SPDX-License-Identifier: GPL-3.0-or-later
// A built-in base in the hand: shifted across its waves, groove or steps, and turned. Previews follow.
import { computed, signal } from '@preact/signals';
import type { Viewport } from '../../../view';
import { along } from '../../../view/vector';
import type { Grip, GripElements, Place } from '../handles/grips';
import { placeAround } from '../handles/grips';
import type { Mover } from '../handles/handles';
import { vectorOf } from '../../../shared/session/report';
import { plateAxesOf } from '../meshes';
import type { ReliefSession } from '../relief_session';
import type { PlateAxes } from './base_place';
import { angleBetween, onPlane, turnedBy } from './base_place';
import type { ShapePlace } from './shape_place';
import { draggedAcross, maxShift_mm, middleOf, shapeByKey } from './shape_place';

/** Shapes that a shift across their direction changes. */
const movable = ['cylinder', 'wave', 'groove', 'stairs'];
const turnable = [...movable, 'strips'];
const names: Readonly<Record<string, string>> = {
  cylinder: 'the cylinder',
  wave: 'the waves',
  groove: 'the groove',
  stairs: 'the stairs',
  strips: 'the strips',
};
/** What lies under the handles: their distance from the middle. */
const halfSize_mm = 30;

export class ShapeMover implements Mover {
  readonly grips = ['move', 'turn'] as const;
  readonly grip = signal<Grip | null>(null);
  readonly #session: ReliefSession;
  #from: { readonly place: ShapePlace; readonly px: Place; readonly middlePx: Place } | null = null;

  constructor(session: ReliefSession) {
    this.#session = session;
  }

  readonly #shape = computed(() => String(this.#session.value('base') ?? 'flat'));

  readonly name = computed(() => names[this.#shape.value] ?? '');

  /** Null where nothing can be moved: a flat base, or one from a file. */
  readonly place = computed((): ShapePlace | null => {
    const shape = this.#shape.value;
    if (this.#session.document.value.base !== null || !turnable.includes(shape)) return null;
    const value = (name: string) => Number(this.#session.value(name) ?? 0);
    return {
      shift_mm: value('base_shift_mm'),
      turn_deg: value('base_turn_deg'),
      movable: movable.includes(shape),
      upwards: shape === 'stairs',
    };
  });

  readonly #axes = computed((): PlateAxes | null => {
    const shown = this.#session.shown.value;
    return shown && plateAxesOf(shown.report);
  });

  /** Where the middle of the shape is seen, and how many pixels a millimetre covers there. */
  #seen(viewport: Viewport): { readonly middlePx: Place; readonly pixelsAMm: number } | null {
    const [place, axes] = [this.place.peek(), this.#axes.peek()];
    if (place === null || axes === null) return null;
    const middleMm = middleOf(place, axes);
    const [middle, beside] = [viewport.project(middleMm), viewport.project(along(middleMm, axes.right, 1))];
    if (middle === null || beside === null) return null;
    return {
      middlePx: [middle.xPx, middle.yPx],
      pixelsAMm: Math.hypot(beside.xPx - middle.xPx, beside.yPx - middle.yPx),
    };
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
    if (grip === 'turn') {
      this.#put(turnedBy(from.place, angleBetween(from.middlePx, from.px, px), free));
      return;
    }
    const [before, now] = [from.px, px].map((at) => onPlane(viewport.rayThrough(at[0], at[1]), axes, 0));
    if (before && now) this.#put(draggedAcross(from.place, [now[0] - before[0], now[1] - before[1]]));
  }

  key(_: Viewport, grip: Grip, key: string, fine: boolean): boolean {
    const place = this.place.peek();
    const next = place && shapeByKey(place, grip, key, fine);
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

  #put(place: ShapePlace): void {
    const turn = { base_turn_deg: place.turn_deg };
    this.#session.setParameters(
      place.movable ? { ...turn, base_shift_mm: this.#within(place) } : turn,
      this.grip.peek() === 'turn' ? 'Turn the base' : 'Move the base',
      'base',
    );
  }

  /** Tenths are finer than anybody drags. */
  #within(place: ShapePlace): number {
    const report = this.#session.shown.peek()?.report;
    const plate_mm = report ? vectorOf(report, 'size_mm') : null;
    const steps = Number(this.#session.value('base_steps') ?? 1);
    const max_mm = plate_mm ? maxShift_mm(place, plate_mm, steps) : Infinity;
    return Number(Math.min(max_mm, Math.max(-max_mm, place.shift_mm)).toFixed(1)) + 0;
  }

  /** `there`: whether the relief on its base is what is looked at. */
  placeHandles(viewport: Viewport, elements: GripElements, there: boolean): void {
    const seen = there ? this.#seen(viewport) : null;
    const middlePx = seen && seen.middlePx;
    const radiusPx = halfSize_mm * (seen?.pixelsAMm ?? 0);
    placeAround(elements, ['turn'], middlePx, radiusPx);
    placeAround(elements, ['move'], this.place.peek()?.movable ? middlePx : null, radiusPx);
  }
}
