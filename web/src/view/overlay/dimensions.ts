// SPDX-License-Identifier: GPL-3.0-or-later
// Dimension lines beside the plate, along its lower and right edge as seen.
import { formatValue } from '../mesh/colour_map';

export interface Point {
  xPx: number;
  yPx: number;
}

export interface DimensionLine {
  from: Point;
  to: Point;
  label: Point;
  angleDeg: number;
}

/** Distance of the line from the edge, px. */
const AWAY_BELOW = 26;
const AWAY_BESIDE = 20;
/** Shorter edges get no line. */
const LEAST = 64;

/** A line parallel to the edge a-b, on the side away from `centre`; null where the edge is too short. */
function dimensionLine(a: Point, b: Point, centre: Point, away: number): DimensionLine | null {
  let [p, q] = [a, b];
  if (q.xPx < p.xPx - 1e-6 || (Math.abs(q.xPx - p.xPx) <= 1e-6 && q.yPx < p.yPx)) [p, q] = [q, p];
  const dx = q.xPx - p.xPx;
  const dy = q.yPx - p.yPx;
  const length = Math.hypot(dx, dy);
  if (length < LEAST) return null;
  let nx = -dy / length;
  let ny = dx / length;
  const middle = { xPx: (p.xPx + q.xPx) / 2, yPx: (p.yPx + q.yPx) / 2 };
  if ((middle.xPx - centre.xPx) * nx + (middle.yPx - centre.yPx) * ny < 0) {
    nx = -nx;
    ny = -ny;
  }
  const move = (s: Point): Point => ({ xPx: s.xPx + away * nx, yPx: s.yPx + away * ny });
  // Nearly upright lines read from top to bottom whichever way they lean.
  let angleDeg = (Math.atan2(dy, dx) * 180) / Math.PI;
  if (angleDeg < -80) angleDeg += 180;
  return { from: move(p), to: move(q), label: move(middle), angleDeg };
}

/** `corners`: lower left, lower right, upper right, upper left of the plate's front on screen. */
export function plateDimensions(corners: readonly [Point, Point, Point, Point]): {
  width: DimensionLine | null;
  height: DimensionLine | null;
} {
  const [a, b, c, d] = corners;
  const centre = { xPx: (a.xPx + b.xPx + c.xPx + d.xPx) / 4, yPx: (a.yPx + b.yPx + c.yPx + d.yPx) / 4 };
  const below = a.yPx + b.yPx >= d.yPx + c.yPx ? ([a, b] as const) : ([d, c] as const);
  const beside = b.xPx + c.xPx >= a.xPx + d.xPx ? ([c, b] as const) : ([d, a] as const);
  return {
    width: dimensionLine(below[0], below[1], centre, AWAY_BELOW),
    height: dimensionLine(beside[0], beside[1], centre, AWAY_BESIDE),
  };
}

const NS = 'http://www.w3.org/2000/svg';

export class Dimensions {
  readonly element = document.createElementNS(NS, 'svg');
  private readonly lines = [0, 1].map(() => {
    const path = document.createElementNS(NS, 'path');
    const text = document.createElementNS(NS, 'text');
    this.element.append(path, text);
    return { path, text };
  });

  constructor() {
    this.element.setAttribute('class', 'fw-dimensions');
    this.element.setAttribute('aria-hidden', 'true');
  }

  draw(corners: readonly [Point, Point, Point, Point] | null, widthMm: number, heightMm: number): void {
    const found = corners ? plateDimensions(corners) : { width: null, height: null };
    this.line(0, found.width, widthMm);
    this.line(1, found.height, heightMm);
  }

  private line(index: number, line: DimensionLine | null, mm: number): void {
    const parts = this.lines[index];
    if (!parts) return;
    const { path, text } = parts;
    path.style.display = text.style.display = line ? '' : 'none';
    if (!line) return;
    const label = formatLength(mm);
    const length = Math.hypot(line.to.xPx - line.from.xPx, line.to.yPx - line.from.yPx);
    const ux = (line.to.xPx - line.from.xPx) / length;
    const uy = (line.to.yPx - line.from.yPx) / length;
    const gap = 3.4 * label.length + 8;
    const at = (p: Point, s: number): string =>
      `${(p.xPx + s * ux).toFixed(2)} ${(p.yPx + s * uy).toFixed(2)}`;
    path.setAttribute(
      'd',
      gap * 2 < length
        ? `M${at(line.from, 0)}L${at(line.label, -gap)}M${at(line.label, gap)}L${at(line.to, 0)}`
        : '',
    );
    text.textContent = label;
    text.setAttribute(
      'transform',
      `translate(${line.label.xPx.toFixed(2)} ${line.label.yPx.toFixed(2)}) rotate(${line.angleDeg.toFixed(2)})`,
    );
  }
}

/** Whole millimetres as "120 mm", others with one digit: "85.5 mm"; small ones with two. */
function formatLength(mm: number): string {
  if (mm < 10) return formatValue(Math.round(mm * 100) / 100, 'mm', 0.01).replace(/\.?0+(?=\u2009)/, '');
  return formatValue(mm, 'mm', Math.abs(mm - Math.round(mm)) < 0.05 ? 1 : 0.1);
}
