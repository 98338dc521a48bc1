// SPDX-License-Identifier: GPL-3.0-or-later
// Times the relief operation natively and in WASM and prints JSON: machine, sizes, stages, memory.
//   node bench_relief.mjs NATIVE_PROGRAM FORMWRIGHT_MJS [--data FOLDER] [--runs N] [--only NAME] [--thin]
// FOLDER holds bunny.obj and koala.obj; without it only built-in samples are measured. Every mesh gets a fresh
// process; the smallest of N runs counts (default 3), because other work on the machine only ever adds time. --thin adds
// 1 %, where thousands of vertices touch their bounds: minutes for some meshes.
import { spawn } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { createInterface } from 'node:readline';
import { fileURLToPath, pathToFileURL } from 'node:url';

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
const round = (value) => (typeof value === 'number' ? Number(value.toPrecision(4)) : value);

function summary(result, seconds) {
  if (result.error) throw new Error(JSON.stringify(result.error));
  const row = { seconds: round(seconds) };
  for (const name of figures) if (name in result.report) row[name] = Number.isInteger(result.report[name]) ? result.report[name] : round(result.report[name]);
  return row;
}

/** A mesh to measure: a file's bytes, or a sample. */
function inputOf(mesh) {
  if (mesh.sample) return { input: { sample: mesh.sample, vertices: mesh.vertices } };
  const bytes = readFileSync(mesh.file), sha256 = createHash('sha256').update(bytes).digest('hex');
  return { input: { sha256, filename: path.basename(mesh.file) }, bytes, sha256 };
}

async function natively(program, mesh) {
  const { input, sha256 } = inputOf(mesh);
  const outputs = mkdtempSync(path.join(os.tmpdir(), 'formwright-bench-'));
  const child = spawn(program, ['run-jobs'], { stdio: ['pipe', 'pipe', 'inherit'] });
  const lines = createInterface({ input: child.stdout })[Symbol.asyncIterator]();
  const rows = [];
  for (const { name, parameters } of asked) {
    const start = performance.now();
    child.stdin.write(JSON.stringify({ run: name, job: relief(input, parameters), blobs: sha256 ? { [sha256]: path.resolve(mesh.file) } : {}, outputs }) + '\n');
    for (;;) {
      const { value, done } = await lines.next();
      if (done) throw new Error('the native program ended');
      const message = JSON.parse(value);
      if (!message.finished) continue;
      rows.push({ asked: name, ...summary(message.result, (performance.now() - start) / 1e3) });
      break;
    }
  }
  child.kill();
  rmSync(outputs, { recursive: true });
  return rows;
}

/** Runs in a process of its own (see the end of this file), because WASM memory never shrinks. */
async function inWasm(module, mesh) {
  const wasm = await (await import(pathToFileURL(path.resolve(module)).href)).default();
  const withText = (text, use) => {
    const size = wasm.lengthBytesUTF8(text) + 1, pointer = wasm._malloc(size);
    wasm.stringToUTF8(text, pointer, size);
    const answer = use(pointer);
    wasm._free(pointer);
    return answer;
  };
  const { input, bytes, sha256 } = inputOf(mesh);
  if (bytes) {
    const pointer = withText(sha256, (p) => wasm._fw_blob_new(p, bytes.length));
    wasm.HEAPU8.set(bytes, pointer);
  }
  return asked.map(({ name, parameters }) => {
    const start = performance.now();
    const result = JSON.parse(wasm.UTF8ToString(withText(JSON.stringify(relief(input, parameters)), (p) => wasm._fw_run(p))));
    return { asked: name, ...summary(result, (performance.now() - start) / 1e3), peak_memory_mb: round(wasm._fw_memory_mb()) };
  });
}

const inFreshProcess = (module, mesh) =>
  new Promise((resolve, reject) => {
    const child = spawn(process.execPath, [fileURLToPath(import.meta.url), '--wasm-child', module, JSON.stringify(mesh), ...process.argv.filter((word) => word === '--thin')], { stdio: ['ignore', 'pipe', 'inherit'] });
    let text = '';
    child.stdout.on('data', (chunk) => (text += chunk));
    child.on('exit', (code) => (code === 0 ? resolve(JSON.parse(text)) : reject(new Error(`the WASM process ended with ${code}`))));
  });

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
      for (let k = 0; k < count; ++k) runs.push(await (backend === 'native' ? natively(program, mesh) : inFreshProcess(module, mesh)));
      const jobs = best(runs);
      for (const job of jobs) process.stderr.write(`${mesh.name.padEnd(18)} ${backend.padEnd(7)} ${job.asked.padEnd(11)} ${job.seconds.toFixed(2).padStart(7)} s ${String(Math.round(job.peak_memory_mb)).padStart(6)} MB\n`);
      results.push({ mesh: mesh.name, backend, jobs });
    }
  }
  rmSync(scratch, { recursive: true });
  const machine = { processor: os.cpus()[0].model, cores: os.cpus().length, memory_gb: round(os.totalmem() / 1e9), node: process.version, load: os.loadavg().map(round) };
  process.stdout.write(JSON.stringify({ bench: 'relief', width_mm, runs_each: count, machine, results }, null, 1) + '\n');
}

if (process.argv[2] === '--wasm-child') process.stdout.write(JSON.stringify(await inWasm(process.argv[3], JSON.parse(process.argv[4]))));
else await main();
