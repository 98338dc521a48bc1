// SPDX-License-Identifier: GPL-3.0-or-later
// Times zippable-design natively and in WASM and prints JSON: machine, sizes, stages, iterations, errors.
//   node bench_zippable.mjs NATIVE_PROGRAM [FORMWRIGHT_MJS] [--runs N] [--vertices N] [--only SAMPLE]
// The thesis's shapes, or ours of the same name, 15,000 vertices (30,000 triangles) each, a ribbon of 12 mm on 100 mm. The smallest
// of N runs counts (default 3). "again" is another number of windings on the same parameterisation. The thesis: 20 s at 30,000 triangles.
import { machine, round, runInWasm, runNatively } from '../jobs.mjs';

const [program, ...rest] = process.argv.slice(2);
const module = rest[0] && !rest[0].startsWith('--') ? rest[0] : undefined;
const option = (name) => (rest.includes(name) ? rest[rest.indexOf(name) + 1] : undefined);
const count = Number(option('--runs') ?? 3), only = option('--only'), vertices = Number(option('--vertices') ?? 15_000);
const figures = ['faces', 'parts', 'iterations', 'distortion_mean', 'distortion_max', 'orders', 'fermat_spirals', 'zipper_length_mm', 'ribbon_width_mean_mm', 'ribbon_width_min_mm',
  'isometry_error', 'ribbon_to_model_mean_mm', 'ribbon_to_model_max_mm', 'seconds_read', 'seconds_parts', 'seconds_parameterisation', 'seconds_curve', 'seconds_ribbon',
  'seconds_distance', 'seconds_write', 'peak_memory_mb'];

const results = [];
for (const sample of ['star', 'heart', 't_shape', 'octopus', 'cat', 'torus'].filter((name) => !only || name === only)) {
  const job = { operation: 'zippable-design', parameters: { width_mm: 12 }, inputs: { mesh: { sample, vertices } } };
  const jobs = [job, { ...job, parameters: { width_mm: 12, windings: 4 } }];
  for (const backend of module ? ['native', 'WASM'] : ['native']) {
    let best, again;
    for (let k = 0; k < count; ++k) {
      const [first, second] = await (backend === 'native' ? runNatively(program, jobs) : runInWasm(module, jobs));
      if (!best || first.report.seconds_parameterisation < best.report.seconds_parameterisation) (best = first), (again = second);
    }
    const row = { sample, backend };
    for (const name of figures) row[name] = round(best.report[name]);
    row.seconds_again = round(again.report.seconds_curve + again.report.seconds_ribbon);
    process.stderr.write(`${sample.padEnd(8)} ${backend.padEnd(7)} parts ${row.seconds_parts} s, parameterisation ${row.seconds_parameterisation} s in ${row.iterations} iterations, again ${row.seconds_again} s\n`);
    results.push(row);
  }
}
process.stdout.write(JSON.stringify({ bench: 'zippable', runs_each: count, machine: machine(), results }, null, 1) + '\n');
