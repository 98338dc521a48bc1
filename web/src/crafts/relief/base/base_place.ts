// SPDX-License-Identifier: GPL-3.0-or-later
// Where a base from a file is, against the plate of its relief, and what a hand or a key makes of that.
import type { Vec3 } from '../../../view';
import { along, dot, subtract } from '../../../view/vector';
import type { Grip, Place } from '../handles/grips';

export interface BasePlace {
  readonly x_mm: number;
  readonly y_mm: number;
  readonly z_mm: number;
  readonly turn_deg: number;
}

/** The plate in the scene: the middle of its front, and its axes as the viewer sees them. */
export interface PlateAxes {
  readonly middleMm: Vec3;
  readonly right: Vec3;
  readonly up: Vec3;
  readonly towards: Vec3;
}

interface Ray {
  readonly originMm: Vec3;
  readonly direction: Vec3;
}

const turnStep_deg = 5;
const keyTurn_deg = 15;
const keyStep_mm = 5;

/** The base's own origin in the scene. */
export const originOf = ({ x_mm, y_mm, z_mm }: BasePlace, axes: PlateAxes): Vec3 =>
  along(along(along(axes.middleMm, axes.right, x_mm), axes.up, y_mm), axes.towards, z_mm);

/** Where a ray of sight meets the plane at that height over the plate, to the right and upwards; null where it runs
 *  along it or away. */
export function onPlane({ originMm, direction }: Ray, axes: PlateAxes, z_mm: number): Place | null {
  const from = subtract(originMm, axes.middleMm);
  const t = (z_mm - dot(from, axes.towards)) / dot(direction, axes.towards);
  if (!(t > 0) || !Number.isFinite(t)) return null;
  const at = along(from, direction, t);
  return [dot(at, axes.right), dot(at, axes.up)];
}

const within180 = (angle_deg: number): number => angle_deg - 360 * Math.round(angle_deg / 360);

/** By how much a pointer goes round a middle, counter-clockwise. */
export function angleBetween(middlePx: Place, fromPx: Place, toPx: Place): number {
  const angle = ([x, y]: Place) => (Math.atan2(middlePx[1] - y, x - middlePx[0]) * 180) / Math.PI;
  return within180(angle(toPx) - angle(fromPx));
}

/** `free`: by any angle rather than in steps of five degrees. */
export function turnedBy<T extends { readonly turn_deg: number }>(
  place: T,
  by_deg: number,
  free: boolean,
): T {
  const step = free ? 1 : turnStep_deg;
  return { ...place, turn_deg: within180(place.turn_deg + step * Math.round(by_deg / step)) };
}

/** Null for keys that do nothing here. */
export function byKey(place: BasePlace, grip: Grip, key: string, fine: boolean): BasePlace | null {
  const step = fine ? 1 : keyStep_mm;
  const across = key === 'ArrowRight' ? 1 : key === 'ArrowLeft' ? -1 : 0;
  const upwards = key === 'ArrowUp' ? 1 : key === 'ArrowDown' ? -1 : 0;
  if (across === 0 && upwards === 0) return null;
  if (grip === 'move')
    return { ...place, x_mm: place.x_mm + step * across, y_mm: place.y_mm + step * upwards };
  // As with the models of a group, up is away from the viewer.
  if (grip === 'depth') return { ...place, z_mm: place.z_mm - step * (across || upwards) };
  return turnedBy(place, (fine ? 1 : keyTurn_deg) * -(across || -upwards), true);
}
