// SPDX-License-Identifier: GPL-3.0-or-later
// Draws the bed with the job on it. A canvas: jobs have a hundred thousand strokes, and the playhead moves through them.
import { detailFor } from '../../../machines/path_detail';
import type { PathDetail, PathPlace, Rectangle, ToolPath } from '../../../machines/toolpath';
import { lastNotAbove, placeAt } from '../../../machines/toolpath';

export interface BedPicture {
  readonly bed_mm: readonly [number, number];
  readonly toolPath: ToolPath | null;
  /** Solid up to here, dashed behind; null: all solid. */
  readonly time_s: number | null;
  readonly head_mm: readonly [number, number] | null;
  readonly showTravel: boolean;
  readonly misfits: boolean;
  /** A square that was chosen. */
  readonly chosen_mm: Rectangle | null;
}

/** From the bed's millimetres, y up, to the canvas's pixels. */
export interface BedFrame {
  readonly scale: number;
  readonly left: number;
  readonly low: number;
}

const margin = { left: 44, top: 14, right: 18, bottom: 30 };
/** By layer, in every picture of the job. */
export const layerColours: Readonly<Record<string, string>> = {
  cut: '--ink',
  mark: '--accent',
  engrave: '--live',
  rough: '--seg-b',
  finish: '--ink',
};

export function frameOf(width: number, height: number, [x_mm, y_mm]: readonly [number, number]): BedFrame {
  const scale = Math.max(
    0.01,
    Math.min((width - margin.left - margin.right) / x_mm, (height - margin.top - margin.bottom) / y_mm),
  );
  const left = margin.left + (width - margin.left - margin.right - scale * x_mm) / 2;
  const low = height - margin.bottom - (height - margin.top - margin.bottom - scale * y_mm) / 2;
  return { scale, left, low };
}

export function drawBed(canvas: HTMLCanvasElement, picture: BedPicture): void {
  const context = canvas.getContext('2d');
  if (context === null) return;
  const ratio = devicePixelRatio || 1;
  const { clientWidth: width, clientHeight: height } = canvas;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const style = getComputedStyle(canvas);
  const colour = (name: string) => style.getPropertyValue(name).trim();
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  const frame = frameOf(width, height, picture.bed_mm);
  const at = (x: number, y: number) => [frame.left + frame.scale * x, frame.low - frame.scale * y] as const;
  drawGround(context, picture, frame, colour, style.fontFamily);
  if (picture.toolPath) {
    const now = picture.time_s === null ? null : placeAt(picture.toolPath, picture.time_s);
    for (const zone of picture.toolPath.no_go_mm) hatch(context, zone, at, colour('--danger'));
    const detail = detailFor(picture.toolPath, 1 / frame.scale / ratio);
    if (picture.showTravel) drawPaths(context, picture.toolPath, detail, 'travel', now, at, colour);
    drawPaths(context, picture.toolPath, detail, 'work', now, at, colour);
    if (now && picture.head_mm === null) drawHead(context, at(now.x_mm, now.y_mm), colour('--live'), null);
  }
  if (picture.chosen_mm) {
    const [left, low, right, high] = picture.chosen_mm;
    const [x, y] = at(left, high);
    context.strokeStyle = colour('--live');
    context.lineWidth = 3;
    context.strokeRect(x - 4, y - 4, frame.scale * (right - left) + 8, frame.scale * (high - low) + 8);
  }
  if (picture.head_mm) {
    const [x, y] = at(...picture.head_mm);
    const [right, top] = at(...picture.bed_mm);
    drawHead(context, [x, y], colour('--live'), [frame.left, top, right, frame.low]);
  }
}

function drawGround(
  context: CanvasRenderingContext2D,
  { bed_mm, misfits }: BedPicture,
  { scale, left, low }: BedFrame,
  colour: (name: string) => string,
  font: string,
): void {
  const [w, h] = [scale * bed_mm[0], scale * bed_mm[1]];
  context.fillStyle = colour('--surface');
  context.fillRect(left, low - h, w, h);
  context.lineWidth = 1;
  const step = [5, 10, 20, 50, 100, 200, 500].find((mm) => mm * scale >= 34) ?? 1000;
  context.font = `11px ${font}`;
  context.strokeStyle = colour('--line');
  context.fillStyle = colour('--ink-3');
  context.beginPath();
  for (let x = 0; x <= bed_mm[0] + 1e-6; x += step) {
    context.moveTo(left + scale * x, low);
    context.lineTo(left + scale * x, low - h);
    context.textAlign = 'center';
    context.fillText(String(x), left + scale * x, low + 16);
  }
  for (let y = 0; y <= bed_mm[1] + 1e-6; y += step) {
    context.moveTo(left, low - scale * y);
    context.lineTo(left + w, low - scale * y);
    context.textAlign = 'right';
    context.fillText(String(y), left - 7, low - scale * y + 4);
  }
  context.stroke();
  context.strokeStyle = misfits ? colour('--danger') : colour('--control');
  context.lineWidth = misfits ? 2 : 1;
  context.strokeRect(left, low - h, w, h);
}

type At = (x: number, y: number) => readonly [number, number];

function drawPaths(
  context: CanvasRenderingContext2D,
  { paths }: ToolPath,
  detail: PathDetail | null,
  kind: 'travel' | 'work',
  now: PathPlace | null,
  at: At,
  colour: (name: string) => string,
): void {
  const travel = kind === 'travel';
  for (const [index, path] of paths.entries()) {
    if (path.kind !== kind) continue;
    const kept = detail?.kept[index] ?? null;
    const last = (kept?.length ?? path.times_s.length) - 1;
    const here = now !== null && index === now.path;
    // Of the points that are drawn, the last one that was reached.
    const reached = here ? (kept ? lastNotAbove(kept, now.point) : now.point) : 0;
    const done = now === null || index < now.path ? last : index > now.path ? 0 : reached;
    const point = (i: number): readonly [number, number] => {
      const p = 3 * (kept ? (kept[i] ?? 0) : i);
      return at(path.points_mm[p] ?? 0, path.points_mm[p + 1] ?? 0);
    };
    context.strokeStyle = colour(travel ? '--ink-3' : (layerColours[path.layer] ?? '--ink'));
    const milled = path.layer === 'rough' || path.layer === 'finish';
    context.lineWidth = travel || milled ? 0.6 : 1.6;
    const stroke = (from: number, to: number, dashed: boolean, tip: boolean) => {
      if (to <= from && !tip) return;
      context.setLineDash(travel ? [2, 3] : dashed ? [4, 3] : []);
      context.globalAlpha = milled ? (dashed ? 0.12 : 0.45) : dashed ? 0.5 : travel ? 0.7 : 1;
      context.beginPath();
      context.moveTo(...point(from));
      for (let i = from + 1; i <= to; ++i) context.lineTo(...point(i));
      if (tip && now) context.lineTo(...at(now.x_mm, now.y_mm));
      context.stroke();
    };
    stroke(0, done, false, here);
    if (now !== null && index >= now.path) stroke(done, last, true, false);
  }
  context.setLineDash([]);
  context.globalAlpha = 1;
}

function drawHead(
  context: CanvasRenderingContext2D,
  [x, y]: readonly [number, number],
  colour: string,
  cross: Rectangle | null,
): void {
  context.strokeStyle = context.fillStyle = colour;
  if (cross) {
    context.setLineDash([3, 3]);
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(cross[0], y);
    context.lineTo(cross[2], y);
    context.moveTo(x, cross[1]);
    context.lineTo(x, cross[3]);
    context.stroke();
    context.setLineDash([]);
  }
  context.lineWidth = 2.5;
  context.beginPath();
  context.arc(x, y, 8, 0, 2 * Math.PI);
  context.stroke();
  context.beginPath();
  context.arc(x, y, 3, 0, 2 * Math.PI);
  context.fill();
}

function hatch(context: CanvasRenderingContext2D, [x0, y0, x1, y1]: Rectangle, at: At, colour: string): void {
  const [left, low] = at(x0, y0);
  const [right, top] = at(x1, y1);
  context.save();
  context.beginPath();
  context.rect(left, top, right - left, low - top);
  context.clip();
  context.strokeStyle = colour;
  context.globalAlpha = 0.6;
  context.lineWidth = 1;
  context.beginPath();
  for (let x = left - (low - top); x < right; x += 8) {
    context.moveTo(x, low);
    context.lineTo(x + (low - top), top);
  }
  context.rect(left, top, right - left, low - top);
  context.stroke();
  context.restore();
}
