// SPDX-License-Identifier: GPL-3.0-or-later
// Runs jobs for the benchmarks, natively or in WASM, each list of jobs in a fresh process: later jobs of a list may
// reuse what the earlier ones left in the session.
import { spawn } from 'node:child_process';
import { createHash } from 'node:crypto';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { createInterface } from 'node:readline';
import { fileURLToPath, pathToFileURL } from 'node:url';

export const round = (value) => (typeof value === 'number' && !Number.isInteger(value) ? Number(value.toPrecision(4)) : value);

export const machine = () => ({ processor: os.cpus()[0].model, cores: os.cpus().length, memory_gb: round(os.totalmem() / 1e9), node: process.version, load: os.loadavg().map(round) });

/** A job's input and the file behind it, if it is one: {file} or {sample, vertices}. */
export function inputOf(mesh) {
  if (mesh.sample) return { input: { sample: mesh.sample, vertices: mesh.vertices } };
  const sha256 = createHash('sha256').update(readFileSync(mesh.file)).digest('hex');
  return { input: { sha256, file_name: path.basename(mesh.file) }, sha256, file: path.resolve(mesh.file) };
}

/** Reports and seconds of `jobs` (job messages), in their order. `files`: path by SHA-256. */
export async function runNatively(program, jobs, files = {}) {
  const outputs = mkdtempSync(path.join(os.tmpdir(), 'formwright-bench-'));
  const child = spawn(program, ['run-jobs'], { stdio: ['pipe', 'pipe', 'inherit'] });
  const lines = createInterface({ input: child.stdout })[Symbol.asyncIterator]();
  const results = [];
  for (const job of jobs) {
    const start = performance.now();
    child.stdin.write(JSON.stringify({ run: String(results.length), job, blobs: files, outputs }) + '\n');
    for (;;) {
      const { value, done } = await lines.next();
      if (done) throw new Error('the native program ended');
      const message = JSON.parse(value);
      if (!message.finished) continue;
      results.push(checked(message.result, start));
      break;
    }
  }
  child.kill();
  rmSync(outputs, { recursive: true });
  return results;
}

/** The same in WASM, in a process of its own, because WASM memory never shrinks. */
export function runInWasm(module, jobs, files = {}) {
  return new Promise((resolve, reject) => {
    const child = spawn(process.execPath, [fileURLToPath(import.meta.url), module], { stdio: ['pipe', 'pipe', 'inherit'] });
    let text = '';
    child.stdout.on('data', (chunk) => (text += chunk));
    child.on('exit', (code) => (code === 0 ? resolve(JSON.parse(text)) : reject(new Error(`the WASM process ended with ${code}`))));
    child.stdin.end(JSON.stringify({ jobs, files }));
  });
}

function checked(result, start) {
  if (result.error) throw new Error(JSON.stringify(result.error));
  return { report: result.report, seconds: (performance.now() - start) / 1e3 };
}

async function wasmChild(module, { jobs, files }) {
  const wasm = await (await import(pathToFileURL(path.resolve(module)).href)).default();
  const withText = (text, use) => {
    const size = wasm.lengthBytesUTF8(text) + 1, pointer = wasm._malloc(size);
    wasm.stringToUTF8(text, pointer, size);
    const answer = use(pointer);
    wasm._free(pointer);
    return answer;
  };
  for (const [sha256, file] of Object.entries(files)) {
    const bytes = readFileSync(file), pointer = withText(sha256, (p) => wasm._fw_blob_new(p, bytes.length));
    wasm.HEAPU8.set(bytes, pointer);
  }
  return jobs.map((job) => {
    const start = performance.now();
    const result = checked(JSON.parse(wasm.UTF8ToString(withText(JSON.stringify(job), (p) => wasm._fw_run(p)))), start);
    result.report.peak_memory_mb = wasm._fw_memory_mb();
    return result;
  });
}

if (process.argv[1] === fileURLToPath(import.meta.url))
  process.stdout.write(JSON.stringify(await wasmChild(process.argv[2], JSON.parse(readFileSync(0, 'utf8')))));
