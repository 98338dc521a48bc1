// SPDX-License-Identifier: GPL-3.0-or-later
// `formwright serve` on a fresh data folder; its address with the token goes to test-results/worker_address, the folder's name to
// test-results/worker_data.
import { spawn } from 'node:child_process';
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';

const root = resolve(import.meta.dirname, '..');
const program = process.env.FORMWRIGHT ?? join(root, 'build/formwright');
const notes = join(import.meta.dirname, 'test-results');
const data = mkdtempSync(join(tmpdir(), 'formwright-e2e-'));
const worker = spawn(
  program,
  ['serve', '--port', process.argv[2], '--data', data, '--web', join(root, 'web/dist')],
  {
    stdio: ['ignore', 'pipe', 'inherit'],
  },
);
worker.stdout.on('data', (text) => {
  const address = /http:\S+/.exec(String(text))?.[0];
  if (!address) return;
  mkdirSync(notes, { recursive: true });
  writeFileSync(join(notes, 'worker_data'), data);
  writeFileSync(join(notes, 'worker_address'), address);
});
const stop = () => worker.kill('SIGTERM');
process.on('SIGTERM', stop);
process.on('SIGINT', stop);
worker.on('exit', (code) => {
  rmSync(data, { recursive: true, force: true });
  process.exit(code ?? 0);
});
