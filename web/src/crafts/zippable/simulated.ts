// SPDX-License-Identifier: GPL-3.0-or-later
// The simulated zipping between its frames.
import type { Film } from '../../jobs/glb';

/** x, y, z per vertex, mm; `share` from 0, flat, to 1, at rest. */
export function frameAt({ frames }: Film, share: number): Float32Array {
  const at = Math.min(1, Math.max(0, share)) * (frames.length - 1);
  const from = frames[Math.floor(at)] ?? new Float32Array(0);
  const to = frames[Math.ceil(at)] ?? from;
  const part = at - Math.floor(at);
  return part === 0 ? from : from.map((value, i) => (1 - part) * value + part * (to[i] ?? value));
}
