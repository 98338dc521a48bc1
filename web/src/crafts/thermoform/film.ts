// SPDX-License-Identifier: GPL-3.0-or-later
// The forming as it goes on: the sheet at any moment between two frames, what it has stretched by then, and how
// the three phases share the timeline.
import type { Film } from '../../jobs/glb';

export interface Moment {
  /** Number of the frame before, and the share of the next one, 0..1. */
  readonly frame: number;
  readonly share: number;
  readonly platform_z_mm: number;
  readonly touching_share: number;
}

export const endOf = ({ times_s }: Film): number => times_s.at(-1) ?? 0;

export function momentAt(film: Film, time_s: number): Moment {
  const { times_s } = film;
  let frame = 0;
  while (frame + 2 < times_s.length && (times_s[frame + 1] ?? Infinity) <= time_s) ++frame;
  const [before = 0, after = before] = [times_s[frame], times_s[frame + 1]];
  const share = after > before ? Math.min(1, Math.max(0, (time_s - before) / (after - before))) : 0;
  const mixed = (values: readonly number[]) =>
    (1 - share) * (values[frame] ?? 0) + share * (values[frame + 1] ?? values[frame] ?? 0);
  return {
    frame,
    share,
    platform_z_mm: mixed(film.platform_z_mm),
    touching_share: mixed(film.touching_share),
  };
}

/** The sheet's vertices at a moment, x, y, z, mm. */
export function sheetAt(film: Film, { frame, share }: Moment): Float32Array<ArrayBuffer> {
  const from = film.frames[frame] ?? new Float32Array(0);
  const to = film.frames[frame + 1];
  if (to === undefined || share === 0) return from as Float32Array<ArrayBuffer>;
  if (share === 1) return to as Float32Array<ArrayBuffer>;
  const out = new Float32Array(from.length);
  for (let i = 0; i < out.length; ++i) out[i] = (1 - share) * (from[i] ?? 0) + share * (to[i] ?? 0);
  return out;
}

/** Twice the area of each vertex's triangles. */
function areasAround(positions: Float32Array, indices: Uint32Array): Float32Array {
  const sums = new Float32Array(positions.length / 3);
  for (let t = 0; t + 2 < indices.length; t += 3) {
    const [a = 0, b = 0, c = 0] = [indices[t], indices[t + 1], indices[t + 2]];
    const side = (to: number, k: number) => (positions[3 * to + k] ?? 0) - (positions[3 * a + k] ?? 0);
    const [ux, uy, uz] = [side(b, 0), side(b, 1), side(b, 2)];
    const [vx, vy, vz] = [side(c, 0), side(c, 1), side(c, 2)];
    const area = Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx);
    for (const vertex of [a, b, c]) sums[vertex] = (sums[vertex] ?? 0) + area;
  }
  return sums;
}

/** Area now over area then, per vertex; the film begins with the flat sheet. */
export class Stretching {
  readonly #flat: Float32Array;
  readonly #film: Film;

  constructor(film: Film) {
    this.#film = film;
    this.#flat = areasAround(film.frames[0] ?? new Float32Array(0), film.indices);
  }

  at(positions: Float32Array): Float32Array<ArrayBuffer> {
    const now = areasAround(positions, this.#film.indices);
    return Float32Array.from(now, (area, i) => ((this.#flat[i] ?? 0) > 0 ? area / (this.#flat[i] ?? 1) : 1));
  }
}

export interface Phase {
  readonly name: string;
  readonly start_s: number;
  readonly end_s: number;
  /** Of the timeline's width, 0..1. */
  readonly from: number;
  readonly to: number;
}

/** A phase is never narrower than its words. */
const minShare = 0.2;

/** The phases along the timeline: as wide as they are long, but none narrower than its words. `ends_s`: where the
 *  phases end, by name; else a phase goes on until the first frame of the next. */
export function phasesOf(film: Film, ends_s: Readonly<Record<string, number | null>> = {}): Phase[] {
  const spans: { name: string; start_s: number; end_s: number }[] = [];
  film.phases.forEach((name, i) => {
    const time = film.times_s[i] ?? 0;
    const last = spans.at(-1);
    if (last?.name === name) last.end_s = time;
    else {
      if (last) last.end_s = Math.min(time, ends_s[last.name] ?? time);
      spans.push({ name, start_s: last?.end_s ?? 0, end_s: time });
    }
  });
  const total = endOf(film);
  const least = Math.min(minShare, 1 / Math.max(1, spans.length));
  const shares = spans.map(({ start_s, end_s }) =>
    total > 0 ? (end_s - start_s) / total : 1 / spans.length,
  );
  const narrow = shares.map((share) => share < least);
  const left = 1 - least * narrow.filter(Boolean).length;
  const wide = shares.reduce((sum, share, i) => (narrow[i] ? sum : sum + share), 0);
  let at = 0;
  return spans.map((span, i) => {
    const width = narrow[i] ? least : wide > 0 ? Math.max(least, ((shares[i] ?? 0) * left) / wide) : 0;
    const from = at;
    at = i === spans.length - 1 ? 1 : Math.min(1, at + width);
    return { ...span, from, to: at };
  });
}

/** The phase that a moment belongs to; its end still does. */
export const phaseAt = (phases: readonly Phase[], time_s: number): string =>
  (phases.find(({ end_s }) => time_s <= end_s) ?? phases.at(-1))?.name ?? '';

/** Place on the timeline, 0..1. */
export function fractionAt(phases: readonly Phase[], time_s: number): number {
  const phase = phases.find(({ end_s }) => time_s <= end_s) ?? phases.at(-1);
  if (phase === undefined) return 0;
  const length = phase.end_s - phase.start_s;
  const share = length > 0 ? Math.min(1, Math.max(0, (time_s - phase.start_s) / length)) : 1;
  return phase.from + share * (phase.to - phase.from);
}

export function timeAt(phases: readonly Phase[], fraction: number): number {
  const wanted = Math.min(1, Math.max(0, fraction));
  const phase = phases.find(({ to }) => wanted <= to) ?? phases.at(-1);
  if (phase === undefined) return 0;
  const width = phase.to - phase.from;
  const share = width > 0 ? (wanted - phase.from) / width : 1;
  return phase.start_s + share * (phase.end_s - phase.start_s);
}
