// SPDX-License-Identifier: GPL-3.0-or-later
// Forms a pyramid at every point of the thesis's calibration grid (4.2.3) and prints JSON: failures, seconds, the range of the results.
//   node sweep_thermoform.mjs NATIVE_PROGRAM [--per-side N] [--triangles N] [--sample NAME]
import { machine, round, runNatively } from '../jobs.mjs';

const [program, ...rest] = process.argv.slice(2);
const option = (name, usual) => (rest.includes(name) ? rest[rest.indexOf(name) + 1] : usual);
const count = Number(option('--per-side', 5)), triangles = Number(option('--triangles', 2500)), sample = option('--sample', 'pyramid');
const values = (low, high) => Array.from({ length: count }, (_, i) => low + ((high - low) * i) / (count - 1));
const jobs = [];
for (const young_modulus_pa of values(5e5, 5e6))
  for (const creep_per_s of values(0, 1000))
    for (const yield_strain of values(0, 0.1))
      for (const viscosity_s of values(0, 1e-4))
        jobs.push({
          operation: 'thermoform-simulate',
          parameters: { triangles, frames: 2, size_mm: 100, young_modulus_pa, creep_per_s, yield_strain, viscosity_s },
          inputs: { mould: { sample, vertices: 2000 } },
          outputs: ['sheet.ply'],
        });

const failures = [], seconds = [], thinnest = [], drift = [];
for (const job of jobs) {
  try {
    const [{ report }] = await runNatively(program, [job]);
    seconds.push(report.seconds_simulation);
    thinnest.push(report.thickness_min_mm);
    drift.push(report.volume_drift);
  } catch (error) {
    failures.push({ parameters: job.parameters, error: error.message });
  }
}
const sum = (list) => list.reduce((a, b) => a + b, 0);
process.stdout.write(
  JSON.stringify(
    {
      bench: 'thermoform grid',
      sample,
      triangles,
      points: jobs.length,
      failed: failures.length,
      failures: failures.slice(0, 10),
      seconds_mean: round(sum(seconds) / seconds.length),
      seconds_max: round(Math.max(...seconds)),
      thickness_min_mm: [round(Math.min(...thinnest)), round(Math.max(...thinnest))],
      volume_drift_max: Math.max(...drift),
      machine: machine(),
    },
    null,
    1,
  ) + '\n',
);
