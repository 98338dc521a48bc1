// SPDX-License-Identifier: GPL-3.0-or-later
// What lies under a pixel of the picture as it is drawn: on the right side of the divider, before the cut.
import type { Hit, Vec3 } from '../api';
import { type CameraState, type Screen, rayThroughPixel } from '../camera/camera';
import type { Picker } from './picker';
import type { PicturePart } from '../render/picture';
import type { Stage } from '../render/stage';
import { add, length, subtract } from '../vector';

export function pickAt(
  stage: Stage,
  picker: Picker,
  camera: CameraState,
  screen: Screen,
  parts: readonly PicturePart[],
  xPx: number,
  yPx: number,
): Hit | null {
  const fraction = xPx / screen.width;
  const shown = parts.find((p) => fraction >= p.from && fraction < p.to);
  if (!shown) return null;
  const { centre, radius } = stage.subjectOf(shown.part).support;
  const back = 4 * radius + length(subtract(camera.target, add(centre, stage.origin)));
  const ray = rayThroughPixel(camera, screen, xPx, yPx, back);
  const origin = subtract(ray.origin, stage.origin);
  const keep = stage.cutTest();
  const mesh = stage.meshOf(shown.part);
  const solids = [...(mesh ? [mesh] : []), ...(shown.part === 'relief' ? stage.plateSurfaces('relief') : [])];
  let best: Hit | null = null;
  let nearest = Infinity;
  for (const surface of solids) {
    const hit = picker.cast(surface, origin, ray.direction, keep ?? undefined);
    if (!hit || hit.distance >= nearest) continue;
    nearest = hit.distance;
    const onMesh = surface === mesh;
    best = {
      part: onMesh ? shown.part : 'plate',
      positionMm: add(hit.point, stage.origin),
      normal: hit.normal,
      triangle: onMesh ? hit.triangle : -1,
      barycentric: hit.barycentric,
      value: onMesh ? valueAt(surface.scalarValues, surface.indices, hit.triangle, hit.barycentric) : null,
      xPx,
      yPx,
    };
  }
  return best;
}

/** Value within a triangle; null without values, or where a corner has none. */
function valueAt(
  values: ArrayLike<number> | null,
  indices: Uint32Array,
  triangle: number,
  weights: Vec3,
): number | null {
  if (!values || triangle < 0) return null;
  let sum = 0;
  for (const k of [0, 1, 2] as const) {
    sum += weights[k] * (values[indices[3 * triangle + k] as number] as number);
  }
  return Number.isFinite(sum) ? sum : null;
}
