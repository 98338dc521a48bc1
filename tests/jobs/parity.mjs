// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the recorded jobs of this folder natively and in WASM and compares both with each other and with what was
// recorded.
//   node parity.mjs NATIVE_PROGRAM FORMWRIGHT_MJS [NAME] [--record]   all jobs, or NAME.json
// A recorded job is {"job", "given", "tolerance", "recorded"}: `given` names inputs that are outputs of other jobs ({"job", "given", "output"}, made
// natively) or JSON files ({"json", "file_name"}) or files of this folder ({"file"}), `tolerance` relative, per figure of the report ("*" for the
// rest; figures that measure time or memory are left out), `recorded` what the report said when it was recorded.
import { spawn } from 'node:child_process';
import { createHash } from 'node:crypto';
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { createInterface } from 'node:readline';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { constants, inflateSync } from 'node:zlib';

const records = process.argv.includes('--record');
const [native, module, only] = process.argv.slice(2).filter((word) => word !== '--record');
const folder = path.dirname(fileURLToPath(import.meta.url));
const timed = (name) => name.startsWith('seconds_') || name === 'peak_memory_mb';

/** Runs one job in a native job process; resolves to its result message and its outputs' bytes. */
function runNatively(job, files = {}) {
  const outputs = mkdtempSync(path.join(tmpdir(), 'formwright-parity-'));
  const child = spawn(native, ['run-jobs'], { stdio: ['pipe', 'pipe', 'inherit'] });
  const inputs = mkdtempSync(path.join(tmpdir(), 'formwright-parity-'));
  const blobs = Object.fromEntries(Object.entries(files).map(([sha256, bytes]) => [sha256, path.join(inputs, sha256)]));
  for (const [sha256, file] of Object.entries(blobs)) writeFileSync(file, files[sha256]);
  child.stdin.write(JSON.stringify({ run: 'x', job, blobs, outputs }) + '\n');
  return new Promise((resolve, reject) => {
    child.on('exit', (code) => reject(new Error(`the native program ended with ${code}`)));
    createInterface({ input: child.stdout }).on('line', (line) => {
      const message = JSON.parse(line);
      if (!message.finished) return;
      child.removeAllListeners('exit');
      child.kill();
      const bytes = {};
      for (const name of Object.keys(message.result.outputs ?? {})) bytes[name] = readFileSync(path.join(outputs, name));
      rmSync(outputs, { recursive: true });
      rmSync(inputs, { recursive: true });
      resolve({ ...message.result, bytes });
    });
  });
}

const wasmModule = async (file) => (await import(pathToFileURL(path.resolve(file)).href)).default();

/** Runs a job in the module that the catalog names for its operation; modules lie beside the first. */
async function wasmRunner() {
  const first = await wasmModule(module);
  const catalog = JSON.parse(first.UTF8ToString(first._fw_catalog()));
  const names = [...new Set(catalog.operations.map((operation) => operation.module))];
  const run = {};
  for (const name of names) {
    const file = path.join(path.dirname(module), `${name}.mjs`);
    run[name] = jobRunner(path.resolve(file) === path.resolve(module) ? first : await wasmModule(file));
  }
  const moduleOf = (job) => catalog.operations.find(({ name }) => name === job.operation)?.module ?? names[0];
  return (job, files) => run[moduleOf(job)](job, files);
}

function jobRunner(wasm) {
  const withText = (text, use) => {
    const size = wasm.lengthBytesUTF8(text) + 1;
    const pointer = wasm._malloc(size);
    wasm.stringToUTF8(text, pointer, size);
    try {
      return use(pointer);
    } finally {
      wasm._free(pointer);
    }
  };
  return (job, files = {}) => {
    for (const [sha256, bytes] of Object.entries(files)) wasm.HEAPU8.set(bytes, withText(sha256, (p) => wasm._fw_blob_new(p, bytes.length)));
    const result = JSON.parse(wasm.UTF8ToString(withText(JSON.stringify(job), (p) => wasm._fw_run(p))));
    const bytes = {};
    for (const name of Object.keys(result.outputs ?? {})) {
      const [data, size] = withText(name, (p) => [wasm._fw_output_data(p), wasm._fw_output_size(p)]);
      bytes[name] = Buffer.from(wasm.HEAPU8.slice(data, data + size));
    }
    return { ...result, bytes };
  };
}

/** Problems between two values of any JSON kind; numbers may differ by `tolerance` of the larger of them and `floor`. */
function differences(name, a, b, tolerance, floor = 0) {
  if (typeof a === 'number' && typeof b === 'number') {
    const allowed = tolerance * Math.max(Math.abs(a), Math.abs(b), floor);
    return Math.abs(a - b) <= allowed ? [] : [`${name}: ${a} and ${b} differ by more than ${allowed}`];
  }
  if (Array.isArray(a) && Array.isArray(b) && a.length === b.length) return a.flatMap((item, i) => differences(`${name}[${i}]`, item, b[i], tolerance, floor));
  const isObject = (value) => typeof value === 'object' && value !== null && !Array.isArray(value);
  if (isObject(a) && isObject(b)) return [...new Set([...Object.keys(a), ...Object.keys(b)])].flatMap((key) => differences(`${name}.${key}`, a[key], b[key], tolerance, floor));
  return JSON.stringify(a) === JSON.stringify(b) ? [] : [`${name}: ${JSON.stringify(a)} and ${JSON.stringify(b)} differ`];
}

function compareReports(a, b, tolerances) {
  const names = new Set([...Object.keys(a), ...Object.keys(b)].filter((name) => !timed(name)));
  return [...names].flatMap((name) => {
    const tolerance = name in tolerances ? tolerances[name] : tolerances['*']; // null: round-off itself, not compared
    return tolerance === null ? [] : differences(name, a[name], b[name], tolerance, 1e-6);
  });
}

/** Files of lengths in mm and counts: below a millimetre the tolerance is that of one. At most ten problems, since a file may have thousands. */
function compareJson(name, a, b, tolerance) {
  return tolerance === null ? [] : differences(name, JSON.parse(a), JSON.parse(b), tolerance, 1).slice(0, 10);
}

/** Vertex columns of a binary PLY as a list of arrays, by a few lines of its own. */
function plyColumns(bytes) {
  const end = bytes.indexOf('end_header\n') + 'end_header\n'.length;
  const header = bytes.subarray(0, end).toString().split('\n');
  const count = Number(header.find((line) => line.startsWith('element vertex')).split(' ')[2]);
  const sizes = { double: 8, float64: 8, float: 4, float32: 4, uchar: 1, uint8: 1, int: 4, int32: 4 };
  const columns = [];
  for (const line of header) {
    if (line.startsWith('element face')) break;
    const [word, type, name] = line.split(' ');
    if (word === 'property') columns.push({ name, type, values: new Float64Array(count) });
  }
  const view = new DataView(bytes.buffer, bytes.byteOffset);
  let at = end;
  for (let i = 0; i < count; ++i)
    for (const column of columns) {
      const size = sizes[column.type];
      column.values[i] = size === 8 ? view.getFloat64(at, true) : size === 1 ? view.getUint8(at) : column.type.startsWith('float') ? view.getFloat32(at, true) : view.getInt32(at, true);
      at += size;
    }
  return columns;
}

function comparePly(name, a, b, tolerance) {
  const left = plyColumns(a);
  const right = plyColumns(b);
  if (left.length !== right.length) return [`${name}: ${left.length} and ${right.length} columns`];
  return left.flatMap((column, c) => {
    const other = right[c].values;
    if (other.length !== column.values.length) return [`${name}: ${column.values.length} and ${other.length} vertices`];
    let worst = 0;
    let size = 1e-6;
    for (let i = 0; i < other.length; ++i) {
      worst = Math.max(worst, Math.abs(other[i] - column.values[i]));
      size = Math.max(size, Math.abs(other[i]));
    }
    return worst <= tolerance * size ? [] : [`${name}: ${column.name} differs by ${worst}, more than ${tolerance * size}`];
  });
}

/** What a PDF says without how it is packed: its streams inflated, and its objects without lengths, places in the file and the name of the
    library that wrote it. Two versions of zlib may pack the same page into different bytes. */
function pdfContent(bytes) {
  const streams = [];
  const inflated = (packed) => inflateSync(Buffer.from(packed, 'latin1'), { finishFlush: constants.Z_SYNC_FLUSH }).toString('latin1');
  const objects = bytes
    .toString('latin1')
    .replace(/\bstream\r?\n([^]*?)\r?\nendstream/g, (_, packed) => `stream ${streams.push(inflated(packed))}`)
    .replace(/\d+ 0 obj\s+\d+\s+endobj/g, 'length')
    .replace(/xref[^]*?trailer/g, 'trailer')
    .replace(/startxref\s+\d+|\/Prev \d+/g, '')
    .replace(/\/Producer \([^)]*\)/, '');
  return { streams, objects };
}

function comparePdf(name, a, b) {
  const [left, right] = [pdfContent(a), pdfContent(b)];
  const problems = left.objects === right.objects ? [] : [`${name}: pages or objects differ between native and WASM`];
  if (left.streams.length === 0) problems.push(`${name} has no streams`);
  left.streams.forEach((stream, i) => {
    if (stream !== right.streams[i]) problems.push(`${name}: stream ${i + 1} of ${left.streams.length} differs between native and WASM`);
  });
  return problems;
}

/** The job with the inputs it is given by other jobs, and their bytes. */
async function withGiven({ job, given = {} }) {
  const files = {};
  const inputs = { ...job.inputs };
  const make = async ({ job: maker, given: makers, output }) => {
    const made = await withGiven({ job: maker, given: makers });
    return (await runNatively(made.job, made.files)).bytes[output];
  };
  for (const [name, input] of Object.entries(given)) {
    const bytes = input.json
      ? Buffer.from(JSON.stringify(input.json))
      : input.file
        ? readFileSync(path.join(folder, input.file))
        : await make(input);
    const sha256 = createHash('sha256').update(bytes).digest('hex');
    files[sha256] = bytes;
    inputs[name] = { sha256, file_name: input.output ?? input.file_name ?? input.file };
  }
  return { job: { ...job, inputs }, files };
}

const runInWasm = await wasmRunner();
let passed = 0;
let failed = 0;
const chosen = readdirSync(folder).filter((name) => (only ? name === `${only}.json` : name.endsWith('.json')));
if (chosen.length === 0) throw new Error(`There is no recorded job ${only}: name a file of ${folder} without .json.`);
for (const file of chosen.sort()) {
  const recorded = JSON.parse(readFileSync(path.join(folder, file), 'utf8'));
  const { job, files } = await withGiven(recorded);
  const a = await runNatively(job, files);
  const b = runInWasm(job, files);
  if (records) {
    const keep = Object.fromEntries(Object.entries(a.report ?? {}).filter(([name]) => !timed(name)));
    recorded.recorded = a.error ? { error: a.error } : { report: keep };
    writeFileSync(path.join(folder, file), JSON.stringify(recorded, null, 2) + '\n');
    continue;
  }
  const problems = [];
  if (a.error || b.error) {
    problems.push(...differences('native and WASM', a.error ?? null, b.error ?? null, 0));
    problems.push(...differences('native and recorded', a.error ?? null, recorded.recorded.error ?? null, 0));
  } else {
    problems.push(...compareReports(a.report, b.report, recorded.tolerance).map((p) => `native and WASM: ${p}`));
    problems.push(...compareReports(a.report, recorded.recorded.report ?? {}, recorded.tolerance).map((p) => `native and recorded: ${p}`));
    for (const name of Object.keys(a.outputs)) {
      if (!b.bytes[name]) problems.push(`${name} is missing in WASM`);
      else if (/\.(gcode|egv|rd)$|^toolpath\.json$/.test(name)) {
        if (!a.bytes[name].equals(b.bytes[name])) problems.push(`${name} differs between native and WASM`);
      } else if (name.endsWith('.pdf')) problems.push(...comparePdf(name, a.bytes[name], b.bytes[name]));
      else if (name.endsWith('.json')) problems.push(...compareJson(name, a.bytes[name], b.bytes[name], 'json' in recorded.tolerance ? recorded.tolerance.json : recorded.tolerance['*']));
      else if (name.endsWith('.ply')) problems.push(...comparePly(name, a.bytes[name], b.bytes[name], recorded.tolerance.ply ?? recorded.tolerance['*']));
    }
  }
  console.log(`${problems.length ? 'FAILED' : 'ok    '} ${file}`);
  for (const problem of problems) console.log(`       ${problem}`);
  problems.length ? ++failed : ++passed;
}
console.log(`${passed} passed, ${failed} failed`);
process.exit(failed > 0 || (passed === 0 && !records) ? 1 : 0);
