// SPDX-License-Identifier: GPL-3.0-or-later
import { type CameraState, type Screen, makeScreen, mmPerPixel } from './camera';
import type { PicturePart } from './stage';

/** Camera, screen and divider for a picture of another size: the whole viewport fits inside, and what lies
 *  beyond its edges fills the rest. */
export function reframed(
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
