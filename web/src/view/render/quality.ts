// SPDX-License-Identifier: GPL-3.0-or-later
// How much drawing a machine can bear. A graphics card gets everything; a machine that draws on its
// processor (a virtual machine, a remote desktop, a blocked driver) gets the same picture with fewer
// samples, because each full pass over a large mesh costs it about 0.1 s, taken from the solver.

export interface Quality {
  readonly antialias: boolean;
  /** Upper bound of the device pixel ratio. */
  readonly pixelRatio: number;
  /** Texels along a side of the key light's depth map, and look-ups into it per pixel. */
  readonly shadowSize: number;
  readonly shadowTaps: number;
  /** Directions from which the sky is baked, texels of each, and the largest mesh that is worth it. */
  readonly skyDirections: number;
  readonly skySize: number;
  readonly skyTriangles: number;
  /** Texels along a side of the ground's shadow. */
  readonly groundSize: number;
  /** Directions baked in one piece of work. */
  readonly skyStep: number;
  /** Pictures averaged for a still view, for a small picture, for a saved one. */
  readonly stillSamples: number;
  readonly smallSamples: number;
  readonly savedSamples: number;
  /** Whether each of them samples another place on the light, which draws the depth map again. */
  readonly softLight: boolean;
  /** Draw aside and copy the finished picture onto the canvas. A browser without a graphics card reads the
   *  canvas back for every frame and stops the page until all that was drawn into it is done. */
  readonly drawsAside: boolean;
  /** Drawing and solving share the processor: refine nothing while something is solved. */
  readonly yieldsToWork: boolean;
  /** Pieces of lines that a moving picture bears. */
  readonly linePieces: number;
  /** Rest of the hand before anything is refined, ms. */
  readonly restMs: number;
}

export const FULL: Quality = {
  antialias: true,
  pixelRatio: 2,
  shadowSize: 2048,
  shadowTaps: 16,
  skyDirections: 80,
  skySize: 1024,
  skyTriangles: Infinity,
  groundSize: 384,
  skyStep: 20,
  stillSamples: 40,
  smallSamples: 14,
  savedSamples: 24,
  softLight: true,
  drawsAside: false,
  yieldsToWork: false,
  linePieces: 600_000,
  restMs: 110,
};

const SPARING: Quality = {
  antialias: false,
  pixelRatio: 1,
  shadowSize: 1024,
  shadowTaps: 5,
  skyDirections: 20,
  skySize: 512,
  skyTriangles: 200_000,
  groundSize: 192,
  skyStep: 1,
  stillSamples: 4,
  smallSamples: 2,
  savedSamples: 8,
  softLight: false,
  drawsAside: true,
  yieldsToWork: true,
  linePieces: 40_000,
  restMs: 350,
};

let known: Quality | null = null;

/** Asks once, with a context of one pixel: the names under which browsers draw on the processor. */
export function qualityHere(): Quality {
  if (known) return known;
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 1;
  const context = canvas.getContext('webgl2');
  const info = context?.getExtension('WEBGL_debug_renderer_info');
  const name = info ? String(context?.getParameter(info.UNMASKED_RENDERER_WEBGL)) : '';
  context?.getExtension('WEBGL_lose_context')?.loseContext();
  known = /swiftshader|llvmpipe|software|basic render/i.test(name) ? SPARING : FULL;
  return known;
}
