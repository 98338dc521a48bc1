// SPDX-License-Identifier: GPL-3.0-or-later
// What the worker does with a file at a machine: printing, slicing, uploading. docs/machine_bridge.md.
import type { ErrorMessage, JsonObject } from '../../jobs/contract';
import { cancelled, JobError } from '../../jobs/contract';
import { sha256Hex } from '../../jobs/hash';
import type { NativeConnection } from '../../jobs/native_connection';

export interface WorkerTask {
  readonly id: string;
  readonly state: 'queued' | 'waiting' | 'sending' | 'printing' | 'slicing' | 'done' | 'failed' | 'cancelled';
  readonly sentence: string;
  readonly fraction: number;
  readonly result?: JsonObject;
  readonly error?: ErrorMessage;
}

export interface TaskOptions {
  readonly signal?: AbortSignal;
  readonly onTask?: (task: WorkerTask) => void;
  /** Between looks at how far it is. */
  readonly look_ms?: number;
}

const atMachine = (machineId: string, rest = '') => `machines/${encodeURIComponent(machineId)}${rest}`;

/** All that the worker knows of a machine. */
export const readMachine = <T>(worker: NativeConnection, machineId: string): Promise<T> =>
  worker.json<T>(atMachine(machineId));

/** Sends the file, orders what is to be done with it, and waits for its end. Throws JobError; `cancelled` once the
 *  signal is raised, when the worker has been told. */
export async function runTask(
  worker: NativeConnection,
  machineId: string,
  order: 'print' | 'upload' | 'slice',
  file: Uint8Array<ArrayBuffer>,
  wishes: JsonObject,
  { signal, onTask, look_ms = 500 }: TaskOptions = {},
): Promise<JsonObject> {
  const sha256 = await sha256Hex(file);
  await worker.requestOk(`blobs/${sha256}`, { method: 'PUT', body: file, ...(signal ? { signal } : {}) });
  const { id } = await worker.json<{ id: string }>(atMachine(machineId, `/${order}`), {
    method: 'POST',
    headers: { 'Content-Type': 'application/json' },
    body: JSON.stringify({ ...wishes, sha256 }),
  });
  const path = atMachine(machineId, `/jobs/${encodeURIComponent(id)}`);
  for (;;) {
    if (signal?.aborted) {
      await worker.request(`${path}/cancel`, { method: 'POST' }).catch(() => undefined);
      throw cancelled();
    }
    const task = await worker.json<WorkerTask>(path);
    onTask?.(task);
    if (task.state === 'done') return task.result ?? {};
    if (task.error) throw new JobError(task.error);
    await restOrAbort(look_ms, signal);
  }
}

/** Gives a print server the G-code under that name, and has it printed at once where `start` is set: only after the person
 *  has confirmed it. The name that the server keeps it under. */
export async function uploadGcode(
  worker: NativeConnection,
  serverId: string,
  gcode: Uint8Array<ArrayBuffer>,
  fileName: string,
  start: boolean,
  options: TaskOptions = {},
): Promise<string> {
  const wishes = { file_name: fileName, ...(start ? { print: true, confirmed: true } : {}) };
  const kept = await runTask(worker, serverId, 'upload', gcode, wishes, options);
  return String(kept['file_name'] ?? fileName);
}

function restOrAbort(ms: number, signal: AbortSignal | undefined): Promise<void> {
  return new Promise((resolve) => {
    const end = () => {
      clearTimeout(timer);
      signal?.removeEventListener('abort', end);
      resolve();
    };
    const timer = setTimeout(end, ms);
    signal?.addEventListener('abort', end);
    if (signal?.aborted) end();
  });
}

/** Ends what a print server prints now. */
export const stopPrintServer = (worker: NativeConnection, machineId: string): Promise<Response> =>
  worker.requestOk(atMachine(machineId, '/stop'), { method: 'POST' });

export async function readBlob(worker: NativeConnection, sha256: string): Promise<Uint8Array<ArrayBuffer>> {
  return new Uint8Array(await (await worker.requestOk(`blobs/${sha256}`)).arrayBuffer());
}
