// SPDX-License-Identifier: GPL-3.0-or-later
// How long and how large a full solve will be, from what was measured on this machine. Factorisations of
// surface meshes grow like n^1.5 in time and n log n in memory (George 1973, nested dissection); of a whole
// relief below a million vertices that is the smaller part, and 8k to 60k vertices took n^1.0 to n^1.2.
import { formatDuration } from '../../ui';

const timeExponent = 1.2;
const memoryExponent = 1.15;
/** Where a browser's 32-bit heap ends. */
export const browserMemory_mb = 4096;

export interface Measured {
  readonly vertices: number;
  readonly seconds: number;
}

export const estimateSeconds = (measured: Measured, vertices: number): number =>
  measured.seconds * Math.max(1, vertices / measured.vertices) ** timeExponent;

export const estimateMemory_mb = (memory_mb: number, measuredVertices: number, vertices: number): number =>
  memory_mb * Math.max(1, vertices / measuredVertices) ** memoryExponent;

const key = (craft: string, backend: string) => `formwright.${craft}.measured.${backend}`;

/** The last full solve of a craft on a backend. */
export function recall(craft: string, backend: string): Measured | null {
  try {
    const stored = JSON.parse(localStorage.getItem(key(craft, backend)) ?? 'null') as Measured | null;
    return stored && stored.vertices > 0 && stored.seconds > 0 ? stored : null;
  } catch {
    return null;
  }
}

export function remember(craft: string, backend: string, measured: Measured): void {
  try {
    localStorage.setItem(key(craft, backend), JSON.stringify(measured));
  } catch {
    // Only an estimate is lost.
  }
}

export interface ExpectedTimes {
  readonly browser_s: number | null;
  readonly worker_s: number | null;
}

/** Of a full solve: from the last one here, else from the preview. */
export function expectedTimes(craft: string, vertices: number, previewed: Measured | null): ExpectedTimes {
  const worker = recall(craft, 'native');
  const browser = recall(craft, 'wasm') ?? previewed;
  return {
    browser_s: browser && estimateSeconds(browser, vertices),
    worker_s: worker && estimateSeconds(worker, vertices),
  };
}

/** "About 8 s in the browser", "About 2 s in the worker program". */
export function timeLine(expected: ExpectedTimes | null, worker: boolean): string {
  const seconds = worker ? expected?.worker_s : expected?.browser_s;
  const where = worker ? 'in the worker program' : 'in the browser';
  if (seconds) return `About ${formatDuration(seconds)} ${where}`;
  return worker ? 'Runs in the worker program' : 'Runs in the browser';
}
