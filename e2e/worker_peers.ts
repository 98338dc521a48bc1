// SPDX-License-Identifier: GPL-3.0-or-later
// Machines that the worker reaches: other people's programs, and the virtual GRBL at a pseudo-terminal.
import type { ChildProcess } from 'node:child_process';
import { execFileSync, spawn, spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { address } from './page';

const root = resolve(import.meta.dirname, '..');
const program = process.env['FORMWRIGHT'] ?? join(root, 'build/formwright');

export const isInstalled = (name: string): boolean =>
  spawnSync('sh', ['-c', `command -v ${name}`]).status === 0;

const workerData = (): string => readFileSync(join(root, 'e2e/test-results/worker_data'), 'utf8');
const machine = (...words: string[]): string =>
  execFileSync(program, ['machine', words[0] ?? '', '--data', workerData(), ...words.slice(1)], {
    encoding: 'utf8',
  });

/** Registered as a person would at this computer; returns its id. */
export const addMachine = (name: string, url: string, ...flags: string[]): string =>
  machine('add', '--name', name, '--url', url, ...flags).split(/\s/)[0] ?? '';
export function removeMachine(name: string): void {
  try {
    machine('remove', name);
  } catch {
    // It was never there.
  }
}

/** The worker's answer to who has its token. */
export async function askWorker<T>(path: string): Promise<T> {
  const url = new URL(address());
  const token = /token=([^&]+)/.exec(url.hash)?.[1] ?? '';
  const answer = await fetch(`${url.origin}/api/${path}`, { headers: { Authorization: `Bearer ${token}` } });
  return (await answer.json()) as T;
}

/** A program that says in its first line how it is reached, and ends with its standard input. */
export class Peer {
  readonly folder = mkdtempSync(join(tmpdir(), 'formwright-peer-'));
  #process: ChildProcess | null = null;

  async start(command: string, ...words: string[]): Promise<string> {
    const child = (this.#process = spawn(command, words, { stdio: ['pipe', 'pipe', 'inherit'] }));
    return await new Promise<string>((done, failed) => {
      let said = '';
      child.stdout.on('data', (text) => {
        said += String(text);
        if (said.includes('\n')) done(said.split('\n')[0] ?? '');
      });
      child.on('exit', (code) => failed(new Error(`${command} ended with ${code} before it was ready.`)));
    });
  }

  async startProgram<T>(kind: 'printer' | 'octoprint', port: number): Promise<T> {
    const peers = execFileSync(join(root, 'setup/test_peers.sh'), ['--print-path'], {
      encoding: 'utf8',
    }).trim();
    const script = join(root, 'tests/native_worker/show_peer.py');
    return JSON.parse(
      await this.start('python3', script, kind, join(this.folder, kind), String(port), peers),
    ) as T;
  }

  startLaser(): Promise<string> {
    return this.start(join(root, 'build/tests/native_worker/virtual_grbl_port'));
  }

  async end(): Promise<void> {
    const child = this.#process;
    if (child && child.exitCode === null) {
      const over = new Promise((done) => child.once('exit', done));
      child.stdin?.end();
      await Promise.race([over, new Promise((done) => setTimeout(done, 10_000))]);
      child.kill();
    }
    rmSync(this.folder, { recursive: true, force: true, maxRetries: 5 });
  }
}
