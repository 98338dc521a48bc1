// SPDX-License-Identifier: GPL-3.0-or-later
// A built-in base in the hand: shifted across its waves, groove or steps, and turned.
import { computed } from '@preact/signals';
import { vectorOf } from '../../../shared/session/report';
import type { Vec3, Viewport } from '../../../view';
import type { Grip, Place } from '../handles/grips';
import type { PlateAxes } from './base_place';
import { onPlane } from './base_place';
import { PlateMover, tenthsWithin } from './plate_mover';
import type { ShapePlace } from './shape_place';
import { draggedAcross, maxShift_mm, middleOf, shapeByKey } from './shape_place';

/** Shapes that a shift across their direction changes. */
const movable = ['cylinder', 'wave', 'groove', 'stairs'];
const names: Readonly<Record<string, string>> = {
  cylinder: 'the cylinder',
  wave: 'the waves',
  groove: 'the groove',
  stairs: 'the stairs',
  strips: 'the strips',
};

export class ShapeMover extends PlateMover<ShapePlace> {
  readonly grips = ['move', 'turn'] as const;
  readonly #shape = computed(() => String(this.session.value('base') ?? 'flat'));
  readonly name = computed(() => names[this.#shape.value] ?? '');

  readonly place = computed((): ShapePlace | null => {
    const shape = this.#shape.value;
    if (this.session.document.value.base !== null || !(shape in names)) return null;
    const value = (name: string) => Number(this.session.value(name) ?? 0);
    return {
      shift_mm: value('base_shift_mm'),
      turn_deg: value('base_turn_deg'),
      movable: movable.includes(shape),
      upwards: shape === 'stairs',
    };
  });

  protected middleOf(place: ShapePlace, axes: PlateAxes): Vec3 {
    return middleOf(place, axes);
  }

  protected byKey(place: ShapePlace, grip: Grip, key: string, fine: boolean): ShapePlace | null {
    return shapeByKey(place, grip, key, fine);
  }

  protected dragged(
    place: ShapePlace,
    _: Grip,
    { viewport, axes, from, to }: { viewport: Viewport; axes: PlateAxes; from: Place; to: Place },
  ): ShapePlace | null {
    const [before, now] = [from, to].map((at) => onPlane(viewport.rayThrough(at[0], at[1]), axes, 0));
    return before && now ? draggedAcross(place, [now[0] - before[0], now[1] - before[1]]) : null;
  }

  protected valuesOf(place: ShapePlace): Record<string, number> {
    const turn = { base_turn_deg: place.turn_deg };
    if (!place.movable) return turn;
    const report = this.session.shown.peek()?.report;
    const plate_mm = report ? vectorOf(report, 'size_mm') : null;
    const max_mm = plate_mm
      ? maxShift_mm(place, plate_mm, Number(this.session.value('base_steps') ?? 1))
      : Infinity;
    return { ...turn, base_shift_mm: tenthsWithin(place.shift_mm, -max_mm, max_mm) };
  }

  protected override moves(place: ShapePlace, grip: Grip): boolean {
    return grip === 'turn' || place.movable;
  }
}
