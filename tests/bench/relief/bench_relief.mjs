// SPDX-License-Identifier: GPL-3.0-or-later
// Times the relief operation natively and in WASM and prints JSON: machine, sizes, stages, memory.
//   node bench_relief.mjs NATIVE_PROGRAM FORMWRIGHT_MJS [--data FOLDER] [--runs N] [--only NAME] [--thin]
// FOLDER holds bunny.obj and koala.obj; without it only built-in samples are measured. Every mesh gets a fresh
// process; the smallest of N runs counts (default 3), because other work on the machine only ever adds time. --thin adds
// 1 %, where thousands of vertices touch their bounds: minutes for some meshes.
import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { inputOf, machine, round, runInWasm, runNatively } from '../jobs.mjs';

const width_mm = 100;
const relief = (mesh, parameters) => ({ operation: 'relief', parameters: { width_mm, ...parameters }, inputs: { mesh }, outputs: ['relief.ply'] });
/** What is asked of every mesh, in this order, in one process: later jobs may reuse the factorisation. */
const asked = [
  { name: '5 %', parameters: { thickness_mm: 5 } },
  { name: '4 %, again', parameters: { thickness_mm: 4 } },
  { name: '2 %, again', parameters: { thickness_mm: 2 } },
];
if (process.argv.includes('--thin')) asked.push({ name: '1 %, again', parameters: { thickness_mm: 1 } });
const stages = ['seconds_read', 'seconds_setup', 'seconds_factorise', 'seconds_solve', 'seconds_write'];
const figures = ['vertices', 'faces', 'visible_vertices', 'order_rows', 'method_used', 'factor_reused', 'rounds', 'active_constraints', 'kkt_residual',
  'energy', 'energy_linear', 'normal_error_mean_deg', 'normal_error_linear_mean_deg', ...stages, 'peak_memory_mb'];

/** What was asked of a mesh, one row each. */
async function rowsOf(run, target, mesh) {
  const { input, sha256, file } = inputOf(mesh);
  const results = await run(target, asked.map(({ parameters }) => relief(input, parameters)), sha256 ? { [sha256]: file } : {});
  return results.map(({ report, seconds }, k) => {
    const row = { asked: asked[k].name, seconds: round(seconds) };
    for (const name of figures) if (name in report) row[name] = round(report[name]);
    return row;
  });
}

/** The koala cut finer: every triangle into four, as the larger one of the thesis's Table 3.1 was made. */
async function subdivided(program, file, folder) {
  const out = path.join(folder, 'finer');
  await new Promise((resolve, reject) => {
    spawn(program, ['subdivide', '--mesh', file, '--out', out], { stdio: ['ignore', 'ignore', 'inherit'] })
      .on('exit', (code) => (code === 0 ? resolve() : reject(new Error(`subdivide ended with ${code}`))));
  });
  return path.join(out, 'subdivided.ply');
}

function best(runs) {
  return runs[0].map((_, k) => runs.map((run) => run[k]).reduce((a, b) => (b.seconds < a.seconds ? b : a)));
}

async function main() {
  const [program, module, ...rest] = process.argv.slice(2);
  const option = (name) => (rest.includes(name) ? rest[rest.indexOf(name) + 1] : undefined);
  const data = option('--data'), count = Number(option('--runs') ?? 3), only = option('--only');
  const scratch = mkdtempSync(path.join(os.tmpdir(), 'formwright-bench-'));
  const meshes = [{ name: 'bust, 10k', sample: 'bust', vertices: 10_000 }, { name: 'bust, 40k', sample: 'bust', vertices: 40_000 }];
  for (const name of ['bunny', 'koala']) {
    const file = data && path.join(data, `${name}.obj`);
    if (file && existsSync(file)) meshes.push({ name, file });
  }
  if (meshes.at(-1).name === 'koala') meshes.push({ name: 'koala, subdivided', file: await subdivided(program, meshes.at(-1).file, scratch) });
  meshes.push({ name: 'bust, 300k', sample: 'bust', vertices: 300_000 });

  const results = [];
  for (const mesh of meshes.filter((m) => !only || m.name.startsWith(only))) {
    for (const backend of ['native', 'WASM']) {
      const runs = [];
      for (let k = 0; k < count; ++k) runs.push(await (backend === 'native' ? rowsOf(runNatively, program, mesh) : rowsOf(runInWasm, module, mesh)));
      const jobs = best(runs);
      for (const job of jobs) process.stderr.write(`${mesh.name.padEnd(18)} ${backend.padEnd(7)} ${job.asked.padEnd(11)} ${job.seconds.toFixed(2).padStart(7)} s ${String(Math.round(job.peak_memory_mb)).padStart(6)} MB\n`);
      results.push({ mesh: mesh.name, backend, jobs });
    }
  }
  rmSync(scratch, { recursive: true });
  process.stdout.write(JSON.stringify({ bench: 'relief', width_mm, runs_each: count, machine: machine(), results }, null, 1) + '\n');
}

await main();
