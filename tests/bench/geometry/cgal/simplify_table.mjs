// SPDX-License-Identifier: GPL-3.0-or-later
// node simplify_table.mjs BUILD [--data FOLDER] [--wasm] [MESH:TARGET...]: simplifies every mesh by every method, one process each, and prints the
// tables of docs/geometry.md. FOLDER holds bunny.obj and lionstatue.obj.
import { spawnSync } from 'node:child_process';

const words = process.argv.slice(2);
const take = (flag) => {
  const at = words.indexOf(flag);
  return at < 0 ? undefined : words.splice(at, 2)[1];
};
const data = take('--data');
const wasm = words.includes('--wasm');
const [build, ...chosen] = words.filter((word) => word !== '--wasm');
if (!build) {
  console.error('node simplify_table.mjs BUILD [--data FOLDER] [--wasm] [MESH:TARGET...]');
  process.exit(2);
}
const usual = ['bust_20000:2000', 'mountain_20000:2000', 't_shape_10000:500'];
const scans = ['bunny.obj:5000', 'lionstatue.obj:5000'].map((name) => `${data}/${name}`);
const meshes = chosen.length ? chosen : [...usual, ...(data ? scans : [])];
const methods = ['ours', 'plane', 'triangle', 'probabilistic_plane', 'probabilistic_triangle', 'probabilistic_plane+smooth', 'plane+ours'];

const digits = (value, count = 2) => (value === null || value === undefined ? '' : Number(value.toPrecision(count)).toString());
const line = (cells) => console.log(`| ${cells.join(' | ')} |`);
const heads = ['mesh', 'method', 'vertices', 's', 'MB', 'angle min', '5 %', 'median', 'full to small, max', 'mean', 'small to full, max', 'mean',
  'normals °', 'boundary', 'creases', 'relief height, mm', 'relief normals °', 'topology'];
line(heads);
line(heads.map((head, i) => (i < 2 ? '---' : '---:')));
for (const one of meshes) {
  const [mesh, target] = one.split(':');
  for (const method of methods) {
    const program = `${build}/tests/bench/geometry/cgal/compare_simplify`;
    const answer = wasm
      ? spawnSync(process.execPath, [`${program}.js`, mesh, target, method], { encoding: 'utf8' })
      : spawnSync(program, [mesh, target, method], { encoding: 'utf8' });
    const name = mesh.split('/').pop().replace('.obj', '');
    if (answer.status !== 0) {
      line([name, method, answer.stderr.trim().split('\n').pop()]);
      continue;
    }
    const r = JSON.parse(answer.stdout);
    const d = r.distance_percent;
    line([name, method, r.vertices, digits(r.seconds), digits(r.megabytes, 3), digits(r.angles_deg.min), digits(r.angles_deg['5_percent'], 3),
      digits(r.angles_deg.median, 3), digits(d.full_to_small_max), digits(d.full_to_small_mean), digits(d.small_to_full_max), digits(d.small_to_full_mean),
      digits(r.normal_mean_deg, 3), digits(r.boundary_percent), digits(r.crease_percent), digits(r.relief.height_rms_mm), digits(r.relief.normal_mean_deg),
      r.manifold && r.same_topology ? 'same' : 'changed']);
  }
}
