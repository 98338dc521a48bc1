// SPDX-License-Identifier: GPL-3.0-or-later
// How much light a point of a surface gets: key light, sky, viewer and fill. The surface's shader is made of the
// same constants (`surface_shaders.ts`), so that what a test says of them holds for the picture.
import type { Vec3 } from '../api';
import { add, along, dot, normalise, scale } from '../vector';

export const KEY = 0.86;
export const AMBIENT = 0.215;
/** Light from the viewer, as a share of the sky's. */
export const VIEWER = 0.35;
/** The fill light's strength where one looks straight against the key light. */
export const FILL = 0.54;
/** Share of the fill light that reaches a place which sees nothing of the sky. */
export const FILL_IN_HOLLOWS = 0.4;
export const KEY_COLOUR: Vec3 = [1, 0.985, 0.955];
export const FILL_COLOUR: Vec3 = [0.975, 1, 1.04];
/** Below and above. */
export const BOUNCE_COLOUR: Vec3 = [0.84, 0.8, 0.76];
export const SKY_COLOUR: Vec3 = [1.02, 1.05, 1.12];
/** How much the middle of the sky leans from the light's up towards its viewer. */
export const SKY_LEAN = 0.7;
/** Oren and Nayar 1994 for a roughness of 0.3 rad, in Fujii's form. */
export const DIFFUSE = 0.9156;
export const ROUGH = 0.156;

/** The axes of a camera or of a light's frame. */
interface Axes {
  readonly right: Vec3;
  readonly up: Vec3;
  readonly forward: Vec3;
}

export interface FillLight {
  /** Unit vector towards it. */
  readonly towards: Vec3;
  readonly strength: number;
}

function smoothstep(low: number, high: number, x: number): number {
  const t = Math.min(1, Math.max(0, (x - low) / (high - low)));
  return t * t * (3 - 2 * t);
}

/** A weak light above the viewer, on the side away from the key light. Nothing while one looks along the key light,
 *  so that a relief keeps its raking shadows. */
export function fillLight(towardsKey: Vec3, camera: Axes): FillLight {
  const viewer = scale(camera.forward, -1);
  const side = dot(towardsKey, camera.right);
  const towards = normalise(along(along(viewer, camera.up, 0.45), camera.right, -0.35 * side));
  return { towards, strength: FILL * smoothstep(0.15, 0.85, (1 - dot(towardsKey, viewer)) / 2) };
}

/** The light's frame, as the picture has it. */
export interface Lights {
  readonly towardsKey: Vec3;
  readonly up: Vec3;
  /** Towards the viewer of the light's frame. */
  readonly front: Vec3;
  readonly fill: FillLight;
}

function orenNayar(l: Vec3, v: Vec3, n: Vec3): number {
  const nl = Math.max(dot(n, l), 0);
  const nv = Math.max(dot(n, v), 0);
  const s = dot(l, v) - nl * nv;
  const t = s > 0 ? Math.max(nl, nv, 1e-3) : 1;
  return nl * (DIFFUSE + (ROUGH * s) / t);
}

/** Red, green and blue light that leaves a white point which sees the whole sky and the key light, linear. */
export function lightAtPoint(normal: Vec3, towardsViewer: Vec3, lights: Lights): Vec3 {
  const { towardsKey, up, front, fill } = lights;
  const key = KEY * orenNayar(towardsKey, towardsViewer, normal);
  const height = 0.5 + 0.5 * dot(normal, normalise(along(up, front, SKY_LEAN)));
  const sky = add(scale(BOUNCE_COLOUR, 1 - height), scale(SKY_COLOUR, height));
  const viewer = VIEWER * Math.max(dot(normal, towardsViewer), 0);
  const filled = fill.strength * Math.max(dot(normal, fill.towards), 0);
  return [0, 1, 2].map(
    (k) => key * (KEY_COLOUR[k] ?? 0) + AMBIENT * ((sky[k] ?? 0) + viewer) + filled * (FILL_COLOUR[k] ?? 0),
  ) as unknown as Vec3;
}
