// SPDX-License-Identifier: GPL-3.0-or-later
// The flat ribbon as SVG paths in mm (y upwards), and how it fits into a pane.
import { tickStep } from '../../../view';
import type { Ribbon } from '../design';

/** A point x, y in mm is drawn at x + pxPerMm * x, y − pxPerMm * y. */
export interface FlatFit {
  readonly x: number;
  readonly y: number;
  readonly pxPerMm: number;
}

/** Room for what is written above and below the ribbon, px; a phone's pane has none above. */
const marginOf = (height: number) =>
  height < 260 ? { side: 16, top: 12, bottom: 44 } : { side: 24, top: 64, bottom: 72 };

export function fitFlat(flat: Float32Array, width: number, height: number): FlatFit {
  const [low, high] = [
    [Infinity, Infinity],
    [-Infinity, -Infinity],
  ];
  flat.forEach((value, i) => {
    low[i % 2] = Math.min(low[i % 2] ?? value, value);
    high[i % 2] = Math.max(high[i % 2] ?? value, value);
  });
  const [x0 = 0, y0 = 0] = low;
  const [x1 = 1, y1 = 1] = high;
  const margin = marginOf(height);
  const room = [Math.max(20, width - 2 * margin.side), Math.max(20, height - margin.top - margin.bottom)];
  const pxPerMm = Math.min(
    (room[0] ?? 1) / Math.max(x1 - x0, 1e-9),
    (room[1] ?? 1) / Math.max(y1 - y0, 1e-9),
  );
  const middle = margin.top + (room[1] ?? 1) / 2;
  return { x: width / 2 - (pxPerMm * (x0 + x1)) / 2, y: middle + (pxPerMm * (y0 + y1)) / 2, pxPerMm };
}

const number = (value: number | undefined): string => String(Math.round(100 * (value ?? 0)) / 100);

/** One path a part; empty for a part that no triangle lies on. */
export function partPaths(
  { flat, triangles }: Pick<Ribbon, 'flat' | 'triangles'>,
  partOf: Int32Array,
  count: number,
): string[] {
  const paths: string[][] = Array.from({ length: count }, () => []);
  partOf.forEach((part, t) => {
    const corners = [0, 1, 2].map((k) => triangles[3 * t + k] ?? 0);
    const points = corners.map((v) => `${number(flat[2 * v])} ${number(flat[2 * v + 1])}`);
    paths[part]?.push(`M${points.join('L')}Z`);
  });
  return paths.map((pieces) => pieces.join(''));
}

export function edgePath(flat: Float32Array, edges: Uint32Array): string {
  let path = '';
  let last = -1;
  for (let i = 0; i < edges.length; i += 2) {
    const [a = 0, b = 0] = edges.subarray(i, i + 2);
    if (a !== last) path += `M${number(flat[2 * a])} ${number(flat[2 * a + 1])}`;
    path += `L${number(flat[2 * b])} ${number(flat[2 * b + 1])}`;
    last = b;
  }
  return path;
}

/** Where the number of each part is written: on its triangle nearest to the middle of all of them. */
export function partLabels(
  { flat, triangles }: Ribbon,
  partOf: Int32Array,
  count: number,
): ([number, number] | null)[] {
  const centre = (t: number): [number, number] => {
    const corner = (k: number, axis: number) => (flat[2 * (triangles[3 * t + k] ?? 0) + axis] ?? 0) / 3;
    return [0, 1].map((axis) => corner(0, axis) + corner(1, axis) + corner(2, axis)) as [number, number];
  };
  return Array.from({ length: count }, (_, part) => {
    const centres = [...partOf.keys()].filter((t) => partOf[t] === part).map(centre);
    if (centres.length === 0) return null;
    const mean = [0, 1].map((axis) => centres.reduce((sum, at) => sum + (at[axis] ?? 0), 0) / centres.length);
    const off = (at: [number, number]) => Math.hypot(at[0] - (mean[0] ?? 0), at[1] - (mean[1] ?? 0));
    return centres.reduce((best, at) => (off(at) < off(best) ? at : best));
  });
}

/** A round length about 80 px long. */
export function scaleBar(pxPerMm: number): { readonly px: number; readonly text: string } {
  const mm = tickStep(0, 80 / pxPerMm, 1);
  const text = mm >= 1000 ? `${mm / 1000}\u2009m` : `${Number(mm.toPrecision(3))}\u2009mm`;
  return { px: mm * pxPerMm, text };
}
