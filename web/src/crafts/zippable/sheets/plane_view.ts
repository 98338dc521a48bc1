// SPDX-License-Identifier: GPL-3.0-or-later
// What part of a plane a pane shows: arithmetic of zooming about a point, dragging and fitting.

export interface Size {
  readonly width: number;
  readonly height: number;
}

/** The place of the plane in the pane's upper left corner, mm, and how large a millimetre is drawn, px. */
export interface PlaneView {
  readonly x: number;
  readonly y: number;
  readonly scale: number;
}

/** Around what is fitted, and how far its edge can be dragged into the pane, px. */
const margin_px = 12;
/** Letters of 1.5 mm are then 60 px high. */
const maxScale = 40;

export const usable = ({ width, height }: Size): boolean => width > 0 && height > 0;

/** All of it, in the middle. */
export function fitted(content: Size, pane: Size): PlaneView {
  const room = (px: number) => Math.max(1, px - 2 * margin_px);
  const scale = Math.min(room(pane.width) / content.width, room(pane.height) / content.height);
  return within({ x: 0, y: 0, scale }, content, pane);
}

/** The nearest view that shows the content: in the middle where it is smaller than the pane, else without empty edges. */
function within({ x, y, scale }: PlaneView, content: Size, pane: Size): PlaneView {
  const margin = margin_px / scale;
  const axis = (at: number, length: number, px: number): number => {
    const shown = px / scale;
    if (length + 2 * margin <= shown) return (length - shown) / 2;
    return Math.min(Math.max(at, -margin), length + margin - shown);
  };
  return { x: axis(x, content.width, pane.width), y: axis(y, content.height, pane.height), scale };
}

/** What lies at `px` from the pane's corner stays there. Never smaller than fitted. */
export function zoomed(
  view: PlaneView,
  factor: number,
  [px, py]: readonly [number, number],
  content: Size,
  pane: Size,
): PlaneView {
  const least = fitted(content, pane).scale;
  const scale = Math.min(Math.max(view.scale * factor, least), Math.max(maxScale, least));
  const [x, y] = [view.x + px / view.scale - px / scale, view.y + py / view.scale - py / scale];
  return within({ x, y, scale }, content, pane);
}

/** By a drag of so many pixels: the plane follows the hand. */
export const dragged = (view: PlaneView, dx: number, dy: number, content: Size, pane: Size): PlaneView =>
  within({ x: view.x - dx / view.scale, y: view.y - dy / view.scale, scale: view.scale }, content, pane);

/** The same place in the middle, after the pane has changed its size. */
export function resized(view: PlaneView, before: Size, content: Size, pane: Size): PlaneView {
  const scale = Math.max(view.scale, fitted(content, pane).scale);
  const centre = (at: number, from: number, to: number) => at + from / 2 / view.scale - to / 2 / scale;
  return within(
    { x: centre(view.x, before.width, pane.width), y: centre(view.y, before.height, pane.height), scale },
    content,
    pane,
  );
}

/** Of a wheel's turn; a pinch on a touchpad comes as a turn with Ctrl, in smaller steps. */
export function wheelFactor({
  deltaY,
  deltaMode,
  ctrlKey,
}: Pick<WheelEvent, 'deltaY' | 'deltaMode' | 'ctrlKey'>): number {
  const px = deltaY * (deltaMode === 1 ? 16 : deltaMode === 2 ? 400 : 1);
  return Math.exp(-Math.max(-200, Math.min(200, px)) * (ctrlKey ? 0.01 : 0.002));
}

export interface Arrangement extends Size {
  /** Upper left corners, mm. */
  readonly places: readonly (readonly [x: number, y: number])[];
}

/** Rows of equal columns: of all numbers of columns the one that shows everything largest. */
export function arranged(sizes: readonly Size[], gap: number, pane: Size): Arrangement {
  const columnWidth = Math.max(...sizes.map(({ width }) => width), 0);
  const rowHeight = Math.max(...sizes.map(({ height }) => height), 0);
  const withColumns = (columns: number): Arrangement => ({
    width: columns * (columnWidth + gap) - gap,
    height: Math.ceil(sizes.length / columns) * (rowHeight + gap) - gap,
    places: sizes.map((_, i) => [
      (i % columns) * (columnWidth + gap),
      Math.floor(i / columns) * (rowHeight + gap),
    ]),
  });
  const choices = sizes.map((_, i) => withColumns(i + 1));
  const scaleOf = (size: Size) => Math.min(pane.width / size.width, pane.height / size.height);
  return choices.reduce((best, next) => (scaleOf(next) > scaleOf(best) ? next : best), withColumns(1));
}
