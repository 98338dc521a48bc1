// SPDX-License-Identifier: GPL-3.0-or-later
// The way a machine's head will go, as `toolpath.json` tells it: where it is at a time, and when it does a line.

export interface ToolPathPart {
  readonly kind: 'travel' | 'work';
  readonly layer: string;
  readonly part: string;
  readonly pass: number;
  readonly power_percent: number;
  readonly speed_mm_per_s: number;
  /** x, y, z after one another. */
  readonly points_mm: ArrayLike<number>;
  /** One a point, from the job's start. */
  readonly times_s: ArrayLike<number>;
  /** The line of the job that moves to each point, from 1. */
  readonly lines: ArrayLike<number>;
}

/** A job of its own, because the tool is changed before it; lines are counted in its own file. */
interface ToolPathStage {
  readonly name: string;
  readonly file: string;
  readonly first_path: number;
  readonly start_s: number;
}

export type Rectangle = readonly [left: number, low: number, right: number, high: number];

/** A tool path with fewer points (path_detail.ts). */
export interface PathDetail {
  readonly tolerance_mm: number;
  /** By path: the numbers of the points that are kept, the first and last among them; null: all. */
  readonly kept: readonly (Uint32Array<ArrayBuffer> | null)[];
  readonly points: number;
}

export interface ToolPath {
  readonly bed_mm: readonly [number, number];
  readonly no_go_mm: readonly Rectangle[];
  readonly seconds: number;
  readonly paths: readonly ToolPathPart[];
  /** In the order in which they run; absent where all of it is one job. */
  readonly stages?: readonly ToolPathStage[];
  /** The same with fewer points, for pictures, the finest first; absent where there are few points. */
  readonly details?: readonly PathDetail[];
}

export function readToolPath(text: string): ToolPath {
  const value = JSON.parse(text) as Partial<ToolPath> & { version?: number };
  if (value.version !== 1 || !Array.isArray(value.paths) || !value.bed_mm)
    throw new Error('This tool path was made by another version: make the job again.');
  return {
    bed_mm: value.bed_mm,
    no_go_mm: value.no_go_mm ?? [],
    seconds: value.seconds ?? 0,
    paths: value.paths,
    ...(value.stages ? { stages: value.stages } : {}),
  };
}

/** Lowest and highest z of what is worked, 0 included: that is the material's surface. */
export function workHeights(toolPath: ToolPath): readonly [number, number] {
  let [low, high] = [0, 0];
  for (const { kind, points_mm } of toolPath.paths)
    for (let i = 2; i < points_mm.length && kind === 'work'; i += 3) {
      low = Math.min(low, points_mm[i] ?? 0);
      high = Math.max(high, points_mm[i] ?? 0);
    }
  return [low, high];
}

/** Of all that is drawn or cut; null where nothing is. */
export function workBounds(toolPath: ToolPath): Rectangle | null {
  const bounds: [number, number, number, number] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const { kind, points_mm } of toolPath.paths) {
    if (kind !== 'work') continue;
    for (let i = 0; i < points_mm.length; i += 3) {
      const [x = 0, y = 0] = [points_mm[i], points_mm[i + 1]];
      bounds[0] = Math.min(bounds[0], x);
      bounds[1] = Math.min(bounds[1], y);
      bounds[2] = Math.max(bounds[2], x);
      bounds[3] = Math.max(bounds[3], y);
    }
  }
  return bounds[0] <= bounds[2] ? bounds : null;
}

/** The index of the last of ascending `values` that is at most `value`; -1 where all are more. */
export function lastNotAbove(values: ArrayLike<number>, value: number): number {
  let [low, high] = [0, values.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((values[middle] ?? Infinity) <= value) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

export interface PathPlace {
  readonly path: number;
  /** The point last reached, and how far on to the next, 0 to 1. */
  readonly point: number;
  readonly fraction: number;
  readonly x_mm: number;
  readonly y_mm: number;
  readonly z_mm: number;
}

/** Where the head is `time_s` after the start; null for an empty path. */
export function placeAt(toolPath: ToolPath, time_s: number): PathPlace | null {
  const starts = startTimes(toolPath);
  const index = Math.max(0, lastNotAbove(starts, time_s));
  const path = toolPath.paths[index];
  if (path === undefined || path.times_s.length === 0) return null;
  const point = Math.max(0, lastNotAbove(path.times_s, time_s));
  const next = Math.min(point + 1, path.times_s.length - 1);
  const [from = 0, to = 0] = [path.times_s[point], path.times_s[next]];
  const fraction = to > from ? Math.min(1, Math.max(0, (time_s - from) / (to - from))) : 0;
  const at = (offset: number) => {
    const [a = 0, b = 0] = [path.points_mm[3 * point + offset], path.points_mm[3 * next + offset]];
    return a + fraction * (b - a);
  };
  return { path: index, point, fraction, x_mm: at(0), y_mm: at(1), z_mm: at(2) };
}

const starts = new WeakMap<ToolPath, number[]>();
function startTimes(toolPath: ToolPath): number[] {
  const known = starts.get(toolPath);
  if (known) return known;
  const made = toolPath.paths.map(({ times_s }) => times_s[0] ?? 0);
  starts.set(toolPath, made);
  return made;
}

/** The path that is run at a time. */
export const partAt = (toolPath: ToolPath, time_s: number): ToolPathPart | undefined =>
  toolPath.paths[Math.max(0, lastNotAbove(startTimes(toolPath), time_s))];

/** When the machine has done this line of the job, of the stage's own where there are several. */
export function timeOfLine(toolPath: ToolPath, line: number, stage = 0): number {
  const { stages, paths } = toolPath;
  let time = stages?.[stage]?.start_s ?? 0;
  const own = stages ? paths.slice(stages[stage]?.first_path, stages[stage + 1]?.first_path) : paths;
  for (const { lines, times_s } of own) {
    if ((lines[0] ?? 0) > line) break;
    time = times_s[Math.max(0, lastNotAbove(lines, line))] ?? time;
  }
  return time;
}

export interface LayerSummary {
  readonly layer: string;
  /** From the least to the most. */
  readonly power_percent: readonly [number, number];
  readonly speed_mm_per_s: readonly [number, number];
  readonly parts: number;
}

const widened = ([low, high]: readonly [number, number], value: number) =>
  [Math.min(low, value), Math.max(high, value)] as const;

/** The layers in the order in which they are worked. */
export function layersOf(toolPath: ToolPath): LayerSummary[] {
  const found = new Map<string, Omit<LayerSummary, 'parts'> & { readonly names: Set<string> }>();
  for (const { kind, layer, part, power_percent: power, speed_mm_per_s: speed } of toolPath.paths) {
    if (kind !== 'work') continue;
    const known = found.get(layer);
    found.set(layer, {
      layer,
      power_percent: widened(known?.power_percent ?? [power, power], power),
      speed_mm_per_s: widened(known?.speed_mm_per_s ?? [speed, speed], speed),
      names: (known?.names ?? new Set()).add(part),
    });
  }
  return [...found.values()].map(({ names, ...layer }) => ({ ...layer, parts: names.size }));
}
