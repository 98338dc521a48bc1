// SPDX-License-Identifier: GPL-3.0-or-later
// Times what the page does for a border while one of its points is dragged, and prints JSON.
//   node bench_dragging.mjs NATIVE_PROGRAM [--vertices N] [--points N] [--steps N]
// Samples of 25,000 vertices (50,000 triangles), a loop through 8 points around them, one point carried along in steps of a thousandth of the
// size. Goal: 60 updates a second, 16 ms each; processor time, which other programs do not inflate, is `processor_ms`. The module that the page runs is built as Vite builds it (esbuild) and run in node.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { machine, round } from '../jobs.mjs';

const [program, ...rest] = process.argv.slice(2);
const option = (name, fallback) => Number(rest.includes(name) ? rest[rest.indexOf(name) + 1] : fallback);
const vertices = option('--vertices', 25_000), count = option('--points', 8), steps = option('--steps', 120);
const web = fileURLToPath(new URL('../../../web/', import.meta.url));
const require = createRequire(join(web, 'package.json'));
const folder = mkdtempSync(join(tmpdir(), 'dragging-'));
const built = join(folder, 'surface_path.mjs');
let bundled = false;
try {
  const { buildSync } = require('esbuild');
  buildSync({ entryPoints: [join(web, 'src/crafts/zippable/surface_path.ts')], bundle: true, format: 'esm', platform: 'neutral', outfile: built, logLevel: 'error' });
  bundled = true;
} catch (error) {
  if (error.code !== 'MODULE_NOT_FOUND') throw error;
}
if (!bundled) {
  const { build } = await import(pathToFileURL(require.resolve('vite')).href.replace(/index\.cjs$/, 'dist/node/index.js'));
  await build({ root: web, configFile: false, logLevel: 'error',
    build: { lib: { entry: join(web, 'src/crafts/zippable/surface_path.ts'), formats: ['es'], fileName: () => 'surface_path.mjs' }, outDir: folder, emptyOutDir: false } });
}
const { SurfaceGraph } = await import(pathToFileURL(built).href);

/** The vertices and triangles of a sample, as OBJ has them. */
function sampleMesh(name) {
  execFileSync(program, ['convert', '--sample', name, '--sample-vertices', String(vertices), '--outputs', 'model.obj', '--quiet', '--out', join(folder, name)], { stdio: 'ignore' });
  const positions = [], indices = [];
  for (const line of readFileSync(join(folder, name, 'model.obj'), 'utf8').split('\n')) {
    const words = line.split(/\s+/);
    if (words[0] === 'v') positions.push(...words.slice(1, 4).map(Number));
    if (words[0] === 'f') indices.push(...words.slice(1, 4).map((word) => parseInt(word, 10) - 1));
  }
  return { positions: Float32Array.from(positions), indices: Uint32Array.from(indices) };
}

const results = [];
for (const sample of ['heart', 'octopus', 'cat']) {
  const { positions, indices } = sampleMesh(sample);
  const began = performance.now();
  const graph = new SurfaceGraph(positions, indices);
  const set_up_ms = performance.now() - began;
  const low = [0, 1, 2].map((k) => positions.reduce((m, x, i) => (i % 3 === k ? Math.min(m, x) : m), Infinity));
  const high = [0, 1, 2].map((k) => positions.reduce((m, x, i) => (i % 3 === k ? Math.max(m, x) : m), -Infinity));
  const size = Math.max(...high.map((x, k) => x - low[k])), middle = high.map((x, k) => 0.5 * (x + low[k]));
  // A circle about its middle, each point at the vertex nearest to it: the page's handles are on the surface.
  const onModel = (at) => {
    let nearest = 0, least = Infinity;
    for (let i = 0; i < positions.length; i += 3) {
      const away = Math.hypot(positions[i] - at[0], positions[i + 1] - at[1], positions[i + 2] - at[2]);
      if (away < least) (least = away), (nearest = i);
    }
    return [...positions.subarray(nearest, nearest + 3)];
  };
  let points = Array.from({ length: count }, (_, i) => {
    const u = (2 * Math.PI * i) / count;
    return onModel([middle[0] + 0.5 * size * Math.cos(u), middle[1] + 0.5 * size * Math.sin(u), middle[2]]);
  });
  graph.through(points, true);
  const times = [];
  const held_at = Array.from({ length: steps }, (_, step) => onModel([points[0][0], points[0][1] + 1e-3 * size * step, points[0][2]]));
  const used = process.cpuUsage();
  for (let step = 0; step < steps; ++step) {
    points = [held_at[step], ...points.slice(1)];
    const before = performance.now();
    graph.through(points, true);
    times.push(performance.now() - before);
  }
  const { user, system } = process.cpuUsage(used);
  times.sort((a, b) => a - b);
  const row = { sample, triangles: indices.length / 3, set_up_ms: round(set_up_ms), processor_ms: round((user + system) / 1000 / steps), median_ms: round(times[Math.floor(0.5 * steps)]), p95_ms: round(times[Math.floor(0.95 * steps)]) };
  process.stderr.write(`${sample.padEnd(8)} ${row.triangles} triangles: ${row.processor_ms} ms of processor time, ${row.median_ms} ms, 95 %: ${row.p95_ms} ms a step, set-up ${row.set_up_ms} ms\n`);
  results.push(row);
}
rmSync(folder, { recursive: true });
process.stdout.write(JSON.stringify({ bench: 'dragging a border', points: count, steps, machine: machine(), results }, null, 1) + '\n');
