// SPDX-License-Identifier: GPL-3.0-or-later
// A set of pictures of what is shown, as when one walks past it.
import type { Zippable } from 'fflate';
import { zip } from 'fflate';
import type { ViewportApi } from '../../../view';

const steps = 17;
const widest_deg = 60;
const picturePx = { width: 720, height: 720 };

/** Angles to the side, from the left to the right, the viewpoint itself in the middle. */
export const walkAngles = (): readonly number[] =>
  Array.from({ length: steps }, (_, i) => -widest_deg + (2 * widest_deg * i) / (steps - 1));

/** PNGs in a zip, named in their order. Ends at the viewpoint. */
export async function walkPast(
  viewport: Pick<ViewportApi, 'lookFromViewpoint' | 'orbit' | 'snapshot'>,
): Promise<Uint8Array<ArrayBuffer>> {
  const files: Zippable = {};
  try {
    for (const [i, angle] of walkAngles().entries()) {
      viewport.lookFromViewpoint(false);
      viewport.orbit(angle, 0);
      const picture = await viewport.snapshot(picturePx.width, picturePx.height);
      const name = `${String(i + 1).padStart(2, '0')}_${angle < 0 ? 'left' : 'right'}_${Math.abs(angle)}_deg.png`;
      files[name] = new Uint8Array(await picture.arrayBuffer());
    }
  } finally {
    viewport.lookFromViewpoint(false);
  }
  // PNGs are packed already.
  return await new Promise((resolve, reject) =>
    zip(files, { level: 0 }, (error, data) =>
      error ? reject(error) : resolve(data as Uint8Array<ArrayBuffer>),
    ),
  );
}
