// SPDX-License-Identifier: GPL-3.0-or-later
// The key light's direction: in the picture, in the model's axes, and in words.
import type { LightDirection, Vec3 } from '../api';
import { add, scale } from '../vector';

export const DEFAULT_LIGHT: LightDirection = { azimuthDeg: 135, elevationDeg: 36, follows: 'object' };

/** Unit vector towards the light. */
export function towardsLight(light: LightDirection, axes: { right: Vec3; up: Vec3; forward: Vec3 }): Vec3 {
  const azimuth = (light.azimuthDeg * Math.PI) / 180;
  const elevation = (Math.min(90, Math.max(0, light.elevationDeg)) * Math.PI) / 180;
  const flat = Math.cos(elevation);
  return add(
    add(scale(axes.right, flat * Math.cos(azimuth)), scale(axes.up, flat * Math.sin(azimuth))),
    scale(axes.forward, -Math.sin(elevation)),
  );
}

/** Where the dot stands on a ball of radius 1 (x right, y up). */
export function dotOf(light: LightDirection): [number, number] {
  const flat = Math.cos((light.elevationDeg * Math.PI) / 180);
  const azimuth = (light.azimuthDeg * Math.PI) / 180;
  return [flat * Math.cos(azimuth), flat * Math.sin(azimuth)];
}

/** The light whose dot is nearest to a place on or off the ball. Never flatter than 5 degrees. */
export function lightAt(x: number, y: number, before: LightDirection): LightDirection {
  const r = Math.min(Math.hypot(x, y), Math.cos((5 * Math.PI) / 180));
  const azimuthDeg = r < 1e-3 ? before.azimuthDeg : normalisedAzimuth((Math.atan2(y, x) * 180) / Math.PI);
  return {
    ...before,
    azimuthDeg: Math.round(azimuthDeg),
    elevationDeg: Math.round((Math.acos(r) * 180) / Math.PI),
  };
}

export function normalisedAzimuth(deg: number): number {
  return ((deg % 360) + 360) % 360;
}

const SIDES = [
  'the right',
  'the upper right',
  'above',
  'the upper left',
  'the left',
  'the lower left',
  'below',
  'the lower right',
];

export function spokenDirection(light: LightDirection): string {
  if (light.elevationDeg >= 85) return 'from the viewer';
  return `from ${SIDES[Math.round(normalisedAzimuth(light.azimuthDeg) / 45) % 8] ?? ''}`;
}

export function spokenLight(light: LightDirection): string {
  return `${spokenDirection(light)}, ${Math.round(light.elevationDeg)} degrees high`;
}
