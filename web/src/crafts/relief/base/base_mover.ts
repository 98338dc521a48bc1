// SPDX-License-Identifier: GPL-3.0-or-later
// A base from a file in the hand.
import { computed } from '@preact/signals';
import type { Vec3, Viewport } from '../../../view';
import type { Grip, Place } from '../handles/grips';
import type { BasePlace, PlateAxes } from './base_place';
import { byKey, onPlane, originOf } from './base_place';
import { PlateMover, tenthsWithin } from './plate_mover';

export class BaseMover extends PlateMover<BasePlace> {
  readonly grips = ['move', 'depth', 'turn'] as const;
  readonly name = computed(() => this.session.document.value.base?.file_name ?? '');

  readonly place = computed((): BasePlace | null => {
    if (this.session.document.value.base === null) return null;
    const value = (name: string) => Number(this.session.value(name) ?? 0);
    return {
      x_mm: value('base_mesh_x_mm'),
      y_mm: value('base_mesh_y_mm'),
      z_mm: value('base_mesh_z_mm'),
      turn_deg: value('base_mesh_turn_deg'),
    };
  });

  protected middleOf(place: BasePlace, axes: PlateAxes): Vec3 {
    return originOf(place, axes);
  }

  protected byKey(place: BasePlace, grip: Grip, key: string, fine: boolean): BasePlace | null {
    return byKey(place, grip, key, fine);
  }

  protected dragged(
    place: BasePlace,
    grip: Grip,
    ways: { viewport: Viewport; axes: PlateAxes; from: Place; to: Place; pixelsAMm: number },
  ): BasePlace | null {
    const { viewport, axes, from, to, pixelsAMm } = ways;
    if (grip === 'depth')
      return pixelsAMm > 0 ? { ...place, z_mm: place.z_mm + (to[1] - from[1]) / pixelsAMm } : null;
    const [before, now] = [from, to].map((at) =>
      onPlane(viewport.rayThrough(at[0], at[1]), axes, place.z_mm),
    );
    if (!before || !now) return null;
    return { ...place, x_mm: place.x_mm + now[0] - before[0], y_mm: place.y_mm + now[1] - before[1] };
  }

  protected valuesOf(place: BasePlace): Record<string, number> {
    return Object.fromEntries(
      Object.entries(place).map(([name, value]) => {
        const parameter = `base_mesh_${name}`;
        const { minimum = -Infinity, maximum = Infinity } =
          this.session.operation.peek()?.parameters.properties[parameter] ?? {};
        return [parameter, tenthsWithin(value, minimum, maximum)];
      }),
    );
  }
}
