// SPDX-License-Identifier: GPL-3.0-or-later
// Small pictures for the gallery and the list of results, all from one hidden context that goes away when idle.
import type { MeshData, ThumbnailOptions, Viewpoint } from '../api';
import { cameraFromViewpoint, fitWindow, makeScreen, projectedBounds } from '../camera/camera';
import { DEFAULT_LIGHT, towardsLight } from './light';
import { encodePng } from './png';
import { FULL, qualityHere } from './quality';
import { boxOf } from '../same';
import { Stage } from './stage';
import { readPalette } from '../theme';
import { add, normalise, scale, viewerAxes } from '../vector';

const IDLE_MS = 4000;
const THREE_QUARTERS: Pick<Viewpoint, 'direction' | 'up'> = { direction: [-0.5, -0.34, -1], up: [0, 1, 0] };

let shared: { stage: Stage; canvas: HTMLCanvasElement } | null = null;
let timer = 0;
let queue: Promise<unknown> = Promise.resolve();

function stage(patient: boolean): Stage {
  clearTimeout(timer);
  if (!shared) {
    const canvas = document.createElement('canvas');
    shared = { stage: new Stage(canvas, { ...(patient ? FULL : qualityHere()), antialias: false }), canvas };
    canvas.addEventListener('webglcontextlost', () => {
      shared = null;
    });
  }
  return shared.stage;
}

function release(): void {
  timer = window.setTimeout(() => {
    const old = shared;
    shared = null;
    old?.stage.dispose();
    old?.stage.renderer.forceContextLoss();
  }, IDLE_MS);
}

/** A PNG picture of `mesh`; one after the other, so that a gallery does not stop the page.
 *  Rejects where WebGL 2 is missing: show a plain tile then. */
export function renderThumbnail(
  mesh: MeshData,
  size: { widthPx: number; heightPx: number },
  options: ThumbnailOptions = {},
): Promise<Blob> {
  const result = queue.then(() => draw(mesh, size, options));
  queue = result.catch(() => undefined);
  return result;
}

async function draw(
  mesh: MeshData,
  { widthPx, heightPx }: { widthPx: number; heightPx: number },
  options: ThumbnailOptions,
): Promise<Blob> {
  const s = stage(options.patient ?? false);
  try {
    s.setPalette(readPalette(options.theme ?? 'auto', document.documentElement));
    const box = boxOf(mesh.positions);
    s.origin = box ? scale(add(box.low, box.high), 0.5) : [0, 0, 0];
    const look = options.viewpoint ?? THREE_QUARTERS;
    const part = options.plate ? 'relief' : 'original';
    const ground = options.ground ?? !options.plate;
    s.setPart(part, mesh, options.plate ?? null, look, ground ? normalise(look.up) : null);
    s.colouring.setMapping(options.mapping ?? null, [part]);
    const support = options.plate ? s.subjectOf(part).support : s.meshSupport(part);
    const viewpoint: Viewpoint = {
      projection: 'perspective',
      targetMm: add(support.centre, s.origin),
      distanceMm: 6 * support.radius,
      fieldOfViewDeg: 20,
      ...look,
    };
    const screen = makeScreen(widthPx, heightPx, { left: 0, top: 0, right: 0, bottom: 0 });
    let camera = cameraFromViewpoint(viewpoint, support.radius);
    const bounds = projectedBounds(camera, support.points, s.origin);
    if (bounds) camera = fitWindow(camera, screen, bounds, 0.1 * Math.min(widthPx, heightPx));
    while (s.bakePendingFor([part])) {
      s.bake([part]);
      s.pace.mark();
      await s.pace.done();
    }
    const axes = viewerAxes(look.direction, look.up);
    const pixels = await s.read(
      {
        camera,
        screen,
        parts: [{ part, from: 0, to: 1 }],
        towardsLight: towardsLight(DEFAULT_LIGHT, axes),
        lightUp: normalise(look.up),
        lightFront: scale(axes.forward, -1),
        backdrop: !options.transparent,
        plateShadow: true,
        ground,
      },
      widthPx,
      heightPx,
      options.patient ? s.quality.savedSamples : s.quality.smallSamples,
    );
    s.setPart(part, null, null, look);
    return await encodePng(pixels, widthPx, heightPx);
  } finally {
    release();
  }
}
