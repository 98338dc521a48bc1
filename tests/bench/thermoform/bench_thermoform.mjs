// SPDX-License-Identifier: GPL-3.0-or-later
// Times thermoform-simulate natively and in WASM and prints JSON: machine, sizes, stages, memory.
//   node bench_thermoform.mjs NATIVE_PROGRAM FORMWRIGHT_MJS [--runs N] [--only SAMPLE] [--large]
// The thesis's models, or ours of the same name, 100 mm large but for the mountain (150 mm), on a sheet of 240 x 260 mm. The smallest of N runs counts (default 3). --large adds 40,000
// and 100,000 triangles on the pyramid, in WASM too. The thesis: 300 s for 10,000 triangles on two Xeon E5-2650 v2.
import { machine, round, runInWasm, runNatively } from '../jobs.mjs';

const [program, module, ...rest] = process.argv.slice(2);
const option = (name) => (rest.includes(name) ? rest[rest.indexOf(name) + 1] : undefined);
const count = Number(option('--runs') ?? 3), only = option('--only');
const cases = [];
for (const sample of ['pyramid', 'hemisphere', 'cat', 'mountain'])
  for (const triangles of [2500, 10_000]) cases.push({ sample, triangles });
if (rest.includes('--large')) for (const triangles of [40_000, 100_000]) cases.push({ sample: 'pyramid', triangles });
const figures = ['triangles', 'steps', 'steps_rejected', 'newton_iterations', 'cg_iterations', 'thickness_min_mm', 'unformed_area_mm2', 'mould_edge_penetration_mm',
  'volume_drift', 'seconds_read', 'seconds_simulation', 'seconds_assembly', 'seconds_linear', 'seconds_contact', 'seconds_write', 'peak_memory_mb'];

const results = [];
for (const { sample, triangles } of cases.filter((c) => !only || c.sample === only)) {
  const job = {
    operation: 'thermoform-simulate',
    parameters: { triangles, size_mm: sample === 'mountain' ? 150 : 100, frames: 2 },
    inputs: { mould: { sample, vertices: 10_000 } },
    outputs: ['sheet.ply'],
  };
  for (const backend of ['native', 'WASM']) {
    let best;
    for (let k = 0; k < count; ++k) {
      const [result] = await (backend === 'native' ? runNatively(program, [job]) : runInWasm(module, [job]));
      if (!best || result.report.seconds_simulation < best.report.seconds_simulation) best = result;
    }
    const row = { sample, backend };
    for (const name of figures) row[name] = round(best.report[name]);
    process.stderr.write(`${sample.padEnd(11)} ${String(triangles).padStart(6)} ${backend.padEnd(7)} ${row.seconds_simulation.toFixed(2).padStart(7)} s ${String(Math.round(row.peak_memory_mb)).padStart(5)} MB\n`);
    results.push(row);
  }
}
process.stdout.write(JSON.stringify({ bench: 'thermoform', runs_each: count, thesis_seconds: 300, machine: machine(), results }, null, 1) + '\n');
