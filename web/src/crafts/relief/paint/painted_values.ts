// SPDX-License-Identifier: GPL-3.0-or-later
// What is painted on each vertex of the model, and as the operation reads it.

export const paintKinds = ['more', 'less', 'free', 'on_base', 'own_thickness'] as const;
export type PaintKind = (typeof paintKinds)[number];

/** One entry a vertex. A vertex may have a weight and a region. */
export interface Painted {
  /** 1: as the rest. */
  readonly weight: Float32Array;
  /** 0: as the rest, else a number of `regions`. */
  readonly region: Uint8Array;
  /** mm, where the region is its own thickness; NaN: as the rest. */
  readonly thickness: Float32Array;
  /** The same behind the base, as a model's file may say it. */
  readonly carve: Float32Array;
}

/** By their numbers, as the operation names them. */
const regions = ['usual', 'free', 'on_base', 'own_thickness'];

export const unpainted = (vertices: number): Painted => ({
  weight: new Float32Array(vertices).fill(1),
  region: new Uint8Array(vertices),
  thickness: new Float32Array(vertices).fill(NaN),
  carve: new Float32Array(vertices).fill(NaN),
});

const copyOf = ({ weight, region, thickness, carve }: Painted): Painted => ({
  weight: weight.slice(),
  region: region.slice(),
  thickness: thickness.slice(),
  carve: carve.slice(),
});

export interface Paint {
  /** Null takes everything away. */
  readonly kind: PaintKind | null;
  /** How many times as much what matters more matters, and what matters less matters less. */
  readonly factor: number;
  readonly thickness_mm: number;
}

/** Writes into `painted`. */
export function paintOn(painted: Painted, vertices: Iterable<number>, { kind, factor, thickness_mm }: Paint) {
  const weight = kind === 'more' ? factor : kind === 'less' ? 1 / factor : null;
  const region = kind === null ? 0 : regions.indexOf(kind);
  for (const v of vertices) {
    if (weight !== null) painted.weight[v] = weight;
    else painted.region[v] = region;
    if (kind === null) painted.weight[v] = 1;
    if (kind !== 'own_thickness') continue;
    painted.thickness[v] = thickness_mm;
    painted.carve[v] = NaN;
  }
}

/** The same without one kind. */
export function without(painted: Painted, kind: PaintKind): Painted {
  const result = copyOf(painted);
  for (let v = 0; v < result.region.length; ++v) {
    if (!isOf(painted, v, kind)) continue;
    if (kind === 'more' || kind === 'less') result.weight[v] = 1;
    else result.region[v] = 0;
  }
  return result;
}

function isOf({ weight, region }: Painted, vertex: number, kind: PaintKind): boolean {
  const w = weight[vertex] ?? 1;
  if (kind === 'more') return w > 1;
  if (kind === 'less') return w < 1;
  return region[vertex] === regions.indexOf(kind);
}

/** What a vertex is coloured by: its region counts before its weight. */
export function kindAt(painted: Painted, vertex: number): PaintKind | null {
  const region = painted.region[vertex] ?? 0;
  if (region > 0) return regions[region] as PaintKind;
  return isOf(painted, vertex, 'more') ? 'more' : isOf(painted, vertex, 'less') ? 'less' : null;
}

/** Vertices of each kind. */
export function counts(painted: Painted): Record<PaintKind, number> {
  const found = { more: 0, less: 0, free: 0, on_base: 0, own_thickness: 0 };
  for (let v = 0; v < painted.region.length; ++v)
    for (const kind of paintKinds) if (isOf(painted, v, kind)) ++found[kind];
  return found;
}

export const isPainted = (painted: Painted): boolean =>
  painted.region.some((region) => region > 0) || painted.weight.some((weight) => weight !== 1);

type Run = [first: number, count: number, value: number | string];

function runsOf<T extends number | string>(length: number, value: (v: number) => T | null): Run[] {
  const runs: Run[] = [];
  for (let v = 0; v < length; ++v) {
    const here = value(v);
    const last = runs.at(-1);
    if (here === null) continue;
    if (last && last[2] === here && last[0] + last[1] === v) ++last[1];
    else runs.push([v, 1, here]);
  }
  return runs;
}

const rounded = (x: number): number => Number(x.toPrecision(5));

/** The operation's input: only what is painted, as runs of vertices that follow each other. */
export function paintingJson(painted: Painted): string {
  const { weight, region, thickness, carve } = painted;
  const n = region.length;
  const depthAt = (depths: Float32Array, v: number) =>
    isOf(painted, v, 'own_thickness') && !Number.isNaN(depths[v]) ? rounded(depths[v] ?? 0) : null;
  const lists = {
    weight: runsOf(n, (v) => (weight[v] === 1 ? null : rounded(weight[v] ?? 1))),
    region: runsOf(n, (v) => (region[v] ? (regions[region[v]] ?? null) : null)),
    thickness_mm: runsOf(n, (v) => depthAt(thickness, v)),
    carve_depth_mm: runsOf(n, (v) => depthAt(carve, v)),
  };
  const there = Object.entries(lists).filter(([, runs]) => runs.length > 0);
  return JSON.stringify({ vertices: n, ...Object.fromEntries(there) });
}

/** Null where the text is no painting of so many vertices. */
export function paintedOf(text: string, vertices: number): Painted | null {
  let file: unknown;
  try {
    file = JSON.parse(text);
  } catch {
    return null;
  }
  if (typeof file !== 'object' || file === null) return null;
  const lists = file as Record<string, unknown>;
  if (lists['vertices'] !== vertices) return null;
  const painted = unpainted(vertices);
  const fill = (name: string, set: (v: number, value: number | string) => void) => {
    const runs = lists[name];
    if (!Array.isArray(runs)) return;
    let left = vertices; // the operation refuses runs that overlap
    for (const [first, count, value] of runs as Run[])
      for (let v = Math.max(0, first); v < Math.min(vertices, first + count) && left > 0; ++v, --left)
        set(v, value);
  };
  fill('weight', (v, value) => (painted.weight[v] = Number(value)));
  fill('region', (v, value) => (painted.region[v] = Math.max(0, regions.indexOf(String(value)))));
  fill('thickness_mm', (v, value) => (painted.thickness[v] = Number(value)));
  fill('carve_depth_mm', (v, value) => (painted.carve[v] = Number(value)));
  return painted;
}

/** What a model's file says by numbers of its vertices; null where it says nothing. */
export function paintedOfAttributes(
  attributes: Readonly<Record<string, Float32Array>>,
  vertices: number,
): Painted | null {
  const { weight, region, thickness_mm, carve_depth_mm } = attributes;
  if (!weight && !region && !thickness_mm && !carve_depth_mm) return null;
  const painted = unpainted(vertices);
  for (let v = 0; v < vertices; ++v) {
    painted.weight[v] = weight?.[v] ?? 1;
    painted.region[v] = region?.[v] ?? (thickness_mm || carve_depth_mm ? 3 : 0);
    painted.thickness[v] = thickness_mm?.[v] ?? NaN;
    painted.carve[v] = carve_depth_mm?.[v] ?? NaN;
  }
  return painted;
}
