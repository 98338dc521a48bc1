// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { arranged, dragged, fitted, resized, wheelFactor, zoomed } from './plane_view';

const sheet = { width: 600, height: 300 };
const pane = { width: 400, height: 500 };
const phone = { width: 390, height: 200 };
/** Where a place of the plane is in the pane, px. */
const at = ({ x, y, scale }: { x: number; y: number; scale: number }, mm: readonly [number, number]) => [
  (mm[0] - x) * scale,
  (mm[1] - y) * scale,
];

describe('a view of a plane', () => {
  it('fits all of it, in the middle', () => {
    for (const size of [pane, phone]) {
      const view = fitted(sheet, size);
      const [left = 0, top = 0] = at(view, [0, 0]);
      const [right = 0, bottom = 0] = at(view, [600, 300]);
      expect(Math.min(left, top)).toBeGreaterThanOrEqual(12 - 1e-9);
      expect(left).toBeCloseTo(size.width - right);
      expect(top).toBeCloseTo(size.height - bottom);
    }
  });

  it('zooms about the pointer: what is under it stays there', () => {
    let view = zoomed(fitted(sheet, pane), 8, [200, 250], sheet, pane); // nothing is smaller than the pane any more
    for (const factor of [1.5, 0.9, 3, 0.5]) {
      const pointer = [170, 260] as const;
      const under = [view.x + pointer[0] / view.scale, view.y + pointer[1] / view.scale] as const;
      view = zoomed(view, factor, pointer, sheet, pane);
      const [x, y] = at(view, under);
      expect(x).toBeCloseTo(pointer[0]);
      expect(y).toBeCloseTo(pointer[1]);
    }
  });

  it('ends at the whole sheet and where letters are large', () => {
    const whole = fitted(sheet, pane);
    expect(zoomed(whole, 0.01, [10, 10], sheet, pane)).toEqual(whole);
    expect(zoomed(whole, 1e6, [200, 250], sheet, pane).scale).toBe(40);
    const tiny = { width: 2, height: 2 };
    expect(zoomed(fitted(tiny, pane), 2, [1, 1], tiny, pane)).toEqual(fitted(tiny, pane)); // larger than that already
  });

  it('follows the hand, and never loses the sheet', () => {
    const view = zoomed(fitted(sheet, pane), 10, [200, 250], sheet, pane);
    const moved = dragged(view, 30, -20, sheet, pane);
    expect((view.x - moved.x) * view.scale).toBeCloseTo(30);
    expect((view.y - moved.y) * view.scale).toBeCloseTo(-20);
    const far = dragged(view, 1e6, -1e6, sheet, pane);
    expect(at(far, [0, 0])[0]).toBeCloseTo(12);
    expect(at(far, [0, 300])[1]).toBeCloseTo(500 - 12);
    const whole = fitted(sheet, pane);
    const pulled = dragged(whole, 50, 50, sheet, pane);
    for (const axis of ['x', 'y', 'scale'] as const) expect(pulled[axis]).toBeCloseTo(whole[axis]);
  });

  it('keeps its middle when the pane is turned from upright to lying', () => {
    const view = zoomed(fitted(sheet, pane), 10, [200, 250], sheet, pane);
    const turned = resized(view, pane, sheet, { width: 500, height: 400 });
    expect(turned.x + 250 / turned.scale).toBeCloseTo(view.x + 200 / view.scale);
    expect(turned.y + 200 / turned.scale).toBeCloseTo(view.y + 250 / view.scale);
    expect(resized(fitted(sheet, phone), phone, sheet, pane).scale).toBeCloseTo(fitted(sheet, pane).scale);
  });

  it('a turn of the wheel and back is none, in lines and pixels', () => {
    for (const deltaMode of [0, 1, 2])
      for (const ctrlKey of [false, true]) {
        const turn = (deltaY: number) => wheelFactor({ deltaY, deltaMode, ctrlKey });
        expect(turn(3) * turn(-3)).toBeCloseTo(1);
        expect(turn(-3)).toBeGreaterThan(1);
        expect(turn(-1e9)).toBeLessThan(8);
      }
  });
});

describe('sheets beside each other', () => {
  const sizes = [1, 2, 3, 4, 5].map(() => sheet);
  it('are stacked in a tall pane and stand in a row in a wide one, none over another', () => {
    const columns = (size: typeof pane) => new Set(arranged(sizes, 20, size).places.map(([x]) => x)).size;
    expect(columns({ width: 200, height: 800 })).toBe(1);
    expect(columns({ width: 3000, height: 100 })).toBe(5);
    const { places, width, height } = arranged(sizes, 20, pane);
    for (const [i, [x, y]] of places.entries()) {
      expect(x + 600).toBeLessThanOrEqual(width);
      expect(y + 300).toBeLessThanOrEqual(height);
      for (const [u, v] of places.slice(0, i))
        expect(Math.abs(u - x) >= 620 || Math.abs(v - y) >= 320).toBe(true);
    }
  });
  it('one is as large as it is', () => {
    expect(arranged([sheet], 20, pane)).toMatchObject({ ...sheet, places: [[0, 0]] });
  });
});
