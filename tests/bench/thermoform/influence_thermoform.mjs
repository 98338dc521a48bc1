// SPDX-License-Identifier: GPL-3.0-or-later
// How far each parameter moves the formed sheet: mean distance (mm) of its vertices from where the defaults put them. Prints JSON.
//   node influence_thermoform.mjs PROGRAM [--sample NAME] [--triangles N]
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';

const [program, ...rest] = process.argv.slice(2);
const option = (name, usual) => (rest.includes(name) ? rest[rest.indexOf(name) + 1] : usual);
const sample = option('--sample', 'pyramid'), triangles = option('--triangles', '10000');
const folder = mkdtempSync(path.join(os.tmpdir(), 'formwright-influence-'));

/** x, y, z of every vertex of a binary PLY whose vertices begin with them as doubles. */
function positions(file) {
  const bytes = readFileSync(file);
  const end = bytes.indexOf('end_header\n') + 11;
  const header = bytes.subarray(0, end).toString('latin1').split('\n');
  const count = Number(header.find((line) => line.startsWith('element vertex')).split(' ')[2]);
  const first = header.findIndex((line) => line.startsWith('element vertex')) + 1;
  const properties = [];
  for (let i = first; header[i].startsWith('property'); ++i) properties.push(header[i].split(' '));
  const sizes = { double: 8, float: 4, uchar: 1, int: 4 };
  const stride = properties.reduce((sum, [, type]) => sum + sizes[type], 0);
  if (properties.slice(0, 3).map(([, type, name]) => type + name).join() !== 'doublex,doubley,doublez') throw new Error('not a sheet of ours');
  return Array.from({ length: count }, (_, v) => [0, 8, 16].map((offset) => bytes.readDoubleLE(end + v * stride + offset)));
}

function formed(flags) {
  const words = ['thermoform-simulate', '--sample', sample, '--size-mm', '100', '--triangles', triangles, '--frames', '2', '--outputs', 'sheet.ply', '--quiet', '--out', folder];
  execFileSync(program, [...words, ...flags], { stdio: 'pipe' });
  return positions(path.join(folder, 'sheet.ply'));
}

const usual = formed([]);
const changes = {
  'Y +20 %': ['--young-modulus-pa', '3.3e6'],
  'creep +20 %': ['--creep-per-s', '600'],
  'yield strain +20 %': ['--yield-strain', '0.12'],
  'viscosity +20 %': ['--viscosity-s', '3e-5'],
  'ramp 0 s': ['--vacuum-ramp-s', '0'],
  'ramp 0.05 s': ['--vacuum-ramp-s', '0.05'],
  'ramp 1 s': ['--vacuum-ramp-s', '1'],
  'purely elastic': ['--creep-per-s', '0'],
  'neo-Hookean': ['--elastic-law', 'stable_neo_hookean'],
  bending: ['--bending', 'on'],
  'total strain': ['--yield-rule', 'total_strain'],
  'steps of 0.25 mm': ['--step-mm', '0.25'],
  'steps of 4 mm': ['--step-mm', '4'],
};
const moved_mm = {};
for (const [name, flags] of Object.entries(changes)) {
  const other = formed(flags);
  moved_mm[name] = Number((usual.reduce((sum, p, v) => sum + Math.hypot(...p.map((value, k) => value - other[v][k])), 0) / usual.length).toPrecision(2));
}
rmSync(folder, { recursive: true });
process.stdout.write(JSON.stringify({ bench: 'thermoform influence', sample, triangles: Number(triangles), vertices: usual.length, moved_mm }, null, 1) + '\n');
