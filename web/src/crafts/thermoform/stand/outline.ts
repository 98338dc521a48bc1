// SPDX-License-Identifier: GPL-3.0-or-later
// Outlines in the picture, in pixels with y down.

export type Pixel = readonly [number, number];

/** Twice the area of an outline; negative where it is counter-clockwise to the eye. */
export const signedArea = (outline: readonly Pixel[]): number =>
  outline.reduce((sum, [x, y], i) => {
    const [nextX, nextY] = outline[(i + 1) % outline.length] ?? [x, y];
    return sum + x * nextY - nextX * y;
  }, 0);

/** How far a point is from an outline, px; 0 inside. */
export function distanceTo(outline: readonly Pixel[], [x, y]: Pixel): number {
  let inside = false;
  let least = Infinity;
  outline.forEach(([ax, ay], i) => {
    const [bx, by] = outline[(i + 1) % outline.length] ?? [ax, ay];
    if (ay > y !== by > y && x < ax + ((y - ay) * (bx - ax)) / (by - ay)) inside = !inside;
    const [dx, dy] = [bx - ax, by - ay];
    const share = Math.min(1, Math.max(0, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1)));
    least = Math.min(least, Math.hypot(x - ax - share * dx, y - ay - share * dy));
  });
  return inside ? 0 : least;
}
