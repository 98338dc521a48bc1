// SPDX-License-Identifier: GPL-3.0-or-later
import { findFlatSides } from './flat_sides';

self.onmessage = ({ data }: MessageEvent<Float32Array | Float64Array>) => {
  self.postMessage(findFlatSides(data));
};
