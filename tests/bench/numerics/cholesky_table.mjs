// SPDX-License-Identifier: GPL-3.0-or-later
// node cholesky_table.mjs NATIVE_BUILD WASM_BUILD|- [--wasm-only] [NAME_UNKNOWNS...]: writes the crafts' matrices into NATIVE_BUILD/cholesky where
// they are missing, factors each by every method on one thread, natively and under node, and prints the tables of docs/numerics.md; last the
// orders alone on two threads, which wants an idle machine.
import { execFileSync, spawnSync } from 'node:child_process';
import { existsSync, mkdirSync } from 'node:fs';

const [native, wasm, ...chosen] = process.argv.slice(2).filter((word) => word !== '--wasm-only');
if (!wasm) {
  console.error('node cholesky_table.mjs NATIVE_BUILD WASM_BUILD|- [--wasm-only] [NAME_UNKNOWNS...]');
  process.exit(2);
}
const usual = [['relief', [10, 50, 200]], ['parameterisation', [10, 50, 200]], ['cloth', [10, 50]]];
const matrices = chosen.length ? chosen : usual.flatMap(([name, thousands]) => thousands.map((k) => `${name}_${k}000`));
const programs = `${native}/tests/bench/numerics`;
const folder = `${native}/cholesky`;
mkdirSync(folder, { recursive: true });

// One thread each: what OpenBLAS and OpenMP start is set here, our own threads in the program.
const env = { ...process.env, OPENBLAS_NUM_THREADS: '1', OMP_NUM_THREADS: '1' };
function run(matrix, method, inWasm, threads = 1) {
  const rounds = matrix.endsWith('_10000.matrix') ? '9' : '3';
  const command = inWasm ? process.execPath : `${programs}/compare_cholesky`;
  const args = inWasm ? [`${wasm}/tests/bench/numerics/compare_cholesky.js`] : [];
  const answer = spawnSync(command, [...args, matrix, method, rounds, String(threads)], { env, encoding: 'utf8' });
  if (answer.status === 0) return JSON.parse(answer.stdout);
  console.error(`${method} on ${matrix}: ${answer.stderr.trim().split('\n').pop()}`);
  return null;
}

const digits = (value) => Number(value.toPrecision(2)).toString();
function table(methods, inWasm) {
  console.log('| matrix | unknowns | method | order s | factor s | solve s | memory MB | entries of L, millions | backward error |');
  console.log('|---|---:|---|---:|---:|---:|---:|---:|---:|');
  for (const matrix of matrices)
    for (const method of methods) {
      const r = run(`${folder}/${matrix}.matrix`, method, inWasm);
      const cells = r
        ? [digits(r.seconds_analyze), digits(r.seconds_factorize), digits(r.seconds_solve), Math.round(r.peak_memory_mb), digits(r.factor_entries / 1e6), r.backward_error.toExponential(0)]
        : Array(6).fill('failed');
      const [name, size] = matrix.split('_');
      console.log(`| ${name} | ${(r?.unknowns ?? Number(size)).toLocaleString('en')} | ${method} | ${cells.join(' | ')} |`);
    }
}

const missing = matrices.filter((matrix) => !existsSync(`${folder}/${matrix}.matrix`));
if (missing.length) execFileSync(`${programs}/cholesky_matrices`, [folder, ...missing], { stdio: ['ignore', 2, 2] });
if (!process.argv.includes('--wasm-only')) {
  console.log('Natively:\n');
  table(['ours', 'cholmod-amd', 'cholmod-metis', 'cholmod-ours', 'eigen-amd'], false);
  console.log('\nOrder and pattern on two threads, seconds of the clock:\n');
  console.log('| matrix | unknowns | ours | CHOLMOD, METIS |\n|---|---:|---:|---:|');
  for (const matrix of matrices) {
    const [ours, metis] = ['ours', 'cholmod-metis'].map((method) => run(`${folder}/${matrix}.matrix`, method, false, 2));
    const seconds = [ours, metis].map((r) => (r ? digits(r.seconds_analyze) : 'failed'));
    console.log(`| ${matrix.split('_')[0]} | ${(ours?.unknowns ?? 0).toLocaleString('en')} | ${seconds.join(' | ')} |`);
  }
}
if (wasm !== '-') {
  console.log('\nWebAssembly, under node:\n');
  table(['ours', 'eigen-amd', 'eigen-ours'], true);
}
