// SPDX-License-Identifier: GPL-3.0-or-later
// The page's side of `toolpath_worker`.
import type { ToolPath } from './toolpath';
import type { ToolPathReply, ToolPathRequest } from './toolpath_messages';

let worker: Worker | null = null;
let nextId = 1;
const waiting = new Map<number, (reply: ToolPathReply) => void>();

function start(): Worker {
  const started = new Worker(new URL('./toolpath_worker.ts', import.meta.url), { type: 'module' });
  started.onmessage = ({ data }: MessageEvent<ToolPathReply>) => {
    waiting.get(data.id)?.(data);
    waiting.delete(data.id);
  };
  started.onerror = () => {
    for (const [id, resolve] of waiting) resolve({ id, error: 'The tool path could not be read.' });
    waiting.clear();
    worker = null;
  };
  return started;
}

async function ask(request: ToolPathRequest): Promise<ToolPath> {
  worker ??= start();
  const answer = new Promise<ToolPathReply>((resolve) => waiting.set(request.id, resolve));
  worker.postMessage(request); // copied: the caller may keep its bytes
  const reply = await answer;
  if ('error' in reply) throw new Error(reply.error);
  return reply.toolPath;
}

/** Of a `toolpath.json`. Throws Error with one sentence. */
export const toolPathOf = (bytes: Uint8Array<ArrayBuffer>): Promise<ToolPath> =>
  ask({ id: nextId++, kind: 'toolpath', bytes });

/** Of a file of G-code. Throws Error with one sentence. */
export const toolPathOfGcode = (
  bytes: Uint8Array<ArrayBuffer>,
  bed_mm: readonly [number, number],
  power_max_s: number,
): Promise<ToolPath> => ask({ id: nextId++, kind: 'gcode', bytes, bed_mm, power_max_s });
