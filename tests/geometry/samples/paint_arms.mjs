// SPDX-License-Identifier: GPL-3.0-or-later
// For the picture of thick surfaces: paints the arms of the octopus that reach towards the viewer free.
//   node paint_arms.mjs MODEL.ply PAINTING.json     MODEL.ply: `formwright import --sample octopus --outputs model.ply`
import { readFileSync, writeFileSync } from 'node:fs';

const [model, painting] = process.argv.slice(2);
const bytes = readFileSync(model);
const end = bytes.indexOf('end_header\n') + 11;
const header = bytes.subarray(0, end).toString();
const count = Number(/^element vertex (\d+)$/m.exec(header)[1]);
const sizes = { double: 8, float: 4, uchar: 1, int: 4 };
const ofVertices = header.slice(0, header.indexOf('element face'));
const stride = [...ofVertices.matchAll(/^property (\w+) \w+$/gm)].reduce((sum, [, type]) => sum + sizes[type], 0);
const region = Array.from({ length: count }, (_, v) => {
  const [x, y, z] = [0, 8, 16].map((offset) => bytes.readDoubleLE(end + v * stride + offset));
  const isArm = Math.hypot(x, z) > 16 && y < 22;
  return isArm && z > 0 && x > -8 ? 'free' : 'usual';
});
writeFileSync(painting, JSON.stringify({ vertices: count, region }));
