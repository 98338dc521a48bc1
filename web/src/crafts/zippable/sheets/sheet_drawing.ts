// SPDX-License-Identifier: GPL-3.0-or-later
// The sheets of a plan's drawing, which has them side by side, one by one: their lines in the colours of their layers.

interface SheetLines {
  readonly layer: string;
  readonly colour: string;
  /** A path in mm from the sheet's upper left corner. */
  readonly d: string;
}

export interface Sheet {
  readonly width_mm: number;
  readonly height_mm: number;
  readonly lines: readonly SheetLines[];
}

type Point = readonly [x: number, y: number];

interface Line {
  readonly points: readonly Point[];
  readonly closed: boolean;
}

/** "M1 2L3 4Z", as plans are written; null for anything else. */
function lineOf(d: string): Line | null {
  if (!/^M[-\d.]+ [-\d.]+(L[-\d.]+ [-\d.]+)*Z?$/.test(d)) return null;
  const points = d
    .replace(/Z$/, '')
    .slice(1)
    .split('L')
    .map((pair): Point => {
      const [x = NaN, y = NaN] = pair.split(' ').map(Number);
      return [x, y];
    });
  return points.flat().every(Number.isFinite) ? { points, closed: d.endsWith('Z') } : null;
}

const rounded = (mm: number): number => Math.round(1000 * mm) / 1000;

const pathOf = ({ points, closed }: Line, [left, top]: Point): string =>
  `${points.map(([x, y], k) => `${k === 0 ? 'M' : 'L'}${rounded(x - left)} ${rounded(y - top)}`).join('')}${closed ? 'Z' : ''}`;

const isColour = (text: string | null): text is string => text !== null && /^#[\da-f]{3,6}$/i.test(text);

/** Only lines and their colours are taken from it. A drawing without frames of sheets is one sheet. */
export function readSheets(svg: string): readonly Sheet[] {
  const root = new DOMParser().parseFromString(svg, 'image/svg+xml').documentElement;
  const box = (root.getAttribute('viewBox') ?? '').split(' ').map(Number);
  const [, , width = NaN, height = NaN] = box;
  if (!(width > 0 && height > 0)) return [];
  const all: { layer: string; colour: string; line: Line }[] = [];
  const frames: { left: number; top: number; right: number; bottom: number }[] = [];
  for (const group of root.querySelectorAll('g'))
    for (const path of group.querySelectorAll('path')) {
      const line = lineOf(path.getAttribute('d') ?? '');
      if (line === null) continue;
      const stroke = group.getAttribute('stroke');
      if (/^sheet-\d+$/.test(path.getAttribute('id') ?? '')) {
        const [xs, ys] = [line.points.map(([x]) => x), line.points.map(([, y]) => y)];
        frames.push({
          left: Math.min(...xs),
          top: Math.min(...ys),
          right: Math.max(...xs),
          bottom: Math.max(...ys),
        });
      } else
        all.push({
          layer: group.getAttribute('id') ?? '',
          colour: isColour(stroke) ? stroke : '#000',
          line,
        });
    }
  if (frames.length === 0) frames.push({ left: 0, top: 0, right: width, bottom: height });
  const sheetOf = ({ points }: Line): number => {
    const middle = points.reduce((sum, [x]) => sum + x, 0) / points.length;
    const distances = frames.map(({ left, right }) => Math.max(left - middle, middle - right, 0));
    return distances.indexOf(Math.min(...distances));
  };
  const paths = frames.map(() => new Map<string, SheetLines>());
  for (const { layer, colour, line } of all) {
    const sheet = sheetOf(line);
    const { left = 0, top = 0 } = frames[sheet] ?? {};
    const before = paths[sheet]?.get(layer)?.d ?? '';
    paths[sheet]?.set(layer, { layer, colour, d: before + pathOf(line, [left, top]) });
  }
  return frames.map(({ left, top, right, bottom }, sheet) => ({
    width_mm: right - left,
    height_mm: bottom - top,
    lines: [...(paths[sheet]?.values() ?? [])],
  }));
}
