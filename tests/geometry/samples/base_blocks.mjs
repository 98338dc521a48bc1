// SPDX-License-Identifier: GPL-3.0-or-later
// A base of several parts for a picture: a wall, two blocks before it, and a board that leans.
//   node base_blocks.mjs OUT.obj
import { writeFileSync } from 'node:fs';

const faces = [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]];
const lines = [];

/** A box around `middle_mm`, turned about the axis towards the viewer, then leaning back. */
function box(middle_mm, size_mm, turn_deg = 0, lean_deg = 0) {
  const first = lines.filter((line) => line.startsWith('v')).length + 1;
  const [turn, lean] = [turn_deg, lean_deg].map((deg) => (deg * Math.PI) / 180);
  for (let corner = 0; corner < 8; ++corner) {
    let [x, y, z] = [0, 1, 2].map((k) => ((corner >> k) & 1 ? 0.5 : -0.5) * size_mm[k]);
    [x, y] = [x * Math.cos(turn) - y * Math.sin(turn), x * Math.sin(turn) + y * Math.cos(turn)];
    [y, z] = [y * Math.cos(lean) - z * Math.sin(lean), y * Math.sin(lean) + z * Math.cos(lean)];
    lines.push(`v ${middle_mm[0] + x} ${middle_mm[1] + y} ${middle_mm[2] + z}`);
  }
  for (const face of faces) lines.push(`f ${face.map((k) => first + k).join(' ')}`);
}

box([0, 0, -60], [150, 170, 12]);
box([-30, 35, -35], [60, 70, 24]);
box([35, 20, -30], [34, 90, 30], -12);
box([-5, -60, -10], [90, 50, 8], 6, -20);
writeFileSync(process.argv[2], `${lines.join('\n')}\n`);
