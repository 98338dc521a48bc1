// SPDX-License-Identifier: GPL-3.0-or-later
// Where a built-in base lies on the plate of its relief, and what a hand or a key makes of that.
import type { Vec3 } from '../../../view';
import { along } from '../../../view/vector';
import type { Grip, Place } from '../handles/grips';
import type { PlateAxes } from './base_place';
import { byKey } from './base_place';

export interface ShapePlace {
  readonly shift_mm: number;
  readonly turn_deg: number;
  /** Whether a shift changes anything. */
  readonly movable: boolean;
  /** Whether it is shifted upwards at 0°, as stairs are, and not to the right. */
  readonly upwards: boolean;
}

/** The direction in which it is shifted, to the right and upwards on the plate. */
function across({ turn_deg, upwards }: ShapePlace): Place {
  const angle = ((turn_deg + (upwards ? 90 : 0)) * Math.PI) / 180;
  return [Math.cos(angle), Math.sin(angle)];
}

/** Its middle on the front of the plate, in the scene. */
export function middleOf(place: ShapePlace, axes: PlateAxes): Vec3 {
  const [right, up] = across(place);
  return along(along(axes.middleMm, axes.right, right * place.shift_mm), axes.up, up * place.shift_mm);
}

/** Of a way over the plate, in millimetres, what lies across the shape counts. */
export function draggedAcross(place: ShapePlace, way_mm: Place): ShapePlace {
  const [right, up] = across(place);
  return { ...place, shift_mm: place.shift_mm + way_mm[0] * right + way_mm[1] * up };
}

/** Null for keys that do nothing here, as arrows along the shape. */
export function shapeByKey(place: ShapePlace, grip: Grip, key: string, fine: boolean): ShapePlace | null {
  const moved = byKey({ x_mm: 0, y_mm: 0, z_mm: 0, turn_deg: place.turn_deg }, grip, key, fine);
  if (moved === null) return null;
  if (grip === 'turn') return { ...place, turn_deg: moved.turn_deg };
  const [right, up] = across(place);
  const way_mm = moved.x_mm * right + moved.y_mm * up;
  if (!place.movable || Math.abs(way_mm) < 1e-9) return null;
  return { ...place, shift_mm: place.shift_mm + Math.sign(way_mm) * Math.hypot(moved.x_mm, moved.y_mm) };
}

/** How far a shape may be shifted: half the plate across it, or less than one step. `plate_mm`: its width and height. */
export function maxShift_mm(place: ShapePlace, plate_mm: readonly number[], steps: number): number {
  const [right, up] = across(place);
  const across_mm = Math.abs(right) * (plate_mm[0] ?? 0) + Math.abs(up) * (plate_mm[1] ?? 0);
  return 0.99 * (place.upwards ? across_mm / steps : 0.5 * across_mm);
}
