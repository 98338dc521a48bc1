// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures that are read back instead of shown: the saved view, and small ones of a part.
import type { Vec3 } from '../api';
import {
  type CameraState,
  type Screen,
  fitWindow,
  makeScreen,
  mmPerPixel,
  projectedBounds,
} from '../camera/camera';
import type { PartName } from './part';
import type { Picture, PicturePart } from './picture';
import type { Stage } from './stage';
import { add } from '../vector';

/** Camera, screen and divider for a picture of another size: the whole viewport fits inside, and what lies
 *  beyond its edges fills the rest. */
function reframed(
  camera: CameraState,
  screen: Screen,
  parts: readonly PicturePart[],
  widthPx: number,
  heightPx: number,
): { camera: CameraState; screen: Screen; parts: PicturePart[] } {
  const factor = Math.min(widthPx / screen.width, heightPx / screen.height);
  const next = makeScreen(widthPx / factor, heightPx / factor, { left: 0, top: 0, right: 0, bottom: 0 });
  const mm = mmPerPixel(camera, screen);
  const dx = screen.width / 2 - (screen.free.left + screen.free.width / 2);
  const dy = screen.height / 2 - (screen.free.top + screen.free.height / 2);
  const shift = (x: number): number =>
    x === 0 || x === 1 ? x : 0.5 + ((x - 0.5) * screen.width) / next.width;
  return {
    camera: {
      ...camera,
      windowX: camera.windowX + dx * mm,
      windowY: camera.windowY - dy * mm,
      halfHeight: (mm * next.height) / 2,
    },
    screen: next,
    parts: parts.map((p) => ({ ...p, from: shift(p.from), to: shift(p.to) })),
  };
}

/** The whole view in another size, finished: r, g, b, a bytes. */
export async function readView(
  stage: Stage,
  picture: Picture,
  widthPx: number,
  heightPx: number,
): Promise<Uint8ClampedArray<ArrayBuffer>> {
  const names = picture.parts.map((p) => p.part);
  while (stage.bakePendingFor(names)) {
    await stage.pace.done();
    stage.bake(names);
    stage.pace.mark();
  }
  const framed = reframed(picture.camera, picture.screen, picture.parts, widthPx, heightPx);
  return await stage.read({ ...picture, ...framed }, widthPx, heightPx, stage.quality.savedSamples);
}

/** One part through another camera, fitted into the picture. */
export async function readPart(
  stage: Stage,
  base: Picture,
  part: PartName,
  cameraFor: (centre: Vec3, radius: number) => CameraState,
  widthPx: number,
  heightPx: number,
): Promise<Uint8ClampedArray<ArrayBuffer>> {
  const { centre, radius, points } = stage.subjectOf(part).support;
  const screen = makeScreen(widthPx, heightPx, { left: 0, top: 0, right: 0, bottom: 0 });
  let camera = cameraFor(add(centre, stage.origin), radius);
  const bounds = projectedBounds(camera, points, stage.origin);
  if (bounds) camera = fitWindow(camera, screen, bounds, 0.09 * heightPx);
  const parts: PicturePart[] = [{ part, from: 0, to: 1 }];
  const picture = { ...base, camera, screen, parts, plateShadow: false, ground: false };
  return await stage.read(picture, widthPx, heightPx, stage.quality.smallSamples);
}
