// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { PlacedModel } from '../../../shared/session/craft_document';
import type { Drag } from './hold';
import { byKey, dragged, maxSize_mm } from './hold';
import { viewAxes } from './placement';

const model: PlacedModel = {
  source: { kind: 'sample', sample: 'cat', title: 'Cat' },
  name: 'Cat',
  size_mm: 80,
  turn_deg: [0, 10, 0],
  at_mm: [1, 2, 3],
};
const front = viewAxes([0, 0, -1], [0, 1, 0]);
const drag = (toPx: [number, number]): Drag => ({
  fromPx: [100, 100],
  toPx,
  middlePx: [60, 100],
  mmAPixel: 0.5,
});

describe('a model in the hand', () => {
  it('follows the pointer in the plane of the picture', () => {
    expect(dragged(model, 'move', drag([120, 90]), front, false).at_mm).toEqual([11, 7, 3]);
    const side = viewAxes([-1, 0, 0], [0, 1, 0]);
    expect(dragged(model, 'move', drag([120, 90]), side, false).at_mm).toEqual([1, 7, -7]);
  });

  it('goes away from the viewer as the pointer goes up', () => {
    expect(dragged(model, 'depth', drag([150, 80]), front, false).at_mm).toEqual([1, 2, -7]);
  });

  it('turns about what is upright in the picture, in steps unless it is free', () => {
    expect(dragged(model, 'turn', drag([143, 0]), front, false).turn_deg).toEqual([0, 30, 0]);
    expect(dragged(model, 'turn', drag([143, 0]), front, true).turn_deg).toEqual([0, 32, 0]);
  });

  it('grows with the distance from its middle, within limits', () => {
    expect(dragged(model, 'size', drag([140, 100]), front, false).size_mm).toBe(160);
    expect(dragged(model, 'size', drag([1e9, 100]), front, false).size_mm).toBe(maxSize_mm);
    expect(dragged(model, 'size', drag([60, 100]), front, false).size_mm).toBe(8);
  });

  it('obeys arrow keys and no others', () => {
    expect(byKey(model, 'move', 'ArrowRight', false, front)?.at_mm).toEqual([6, 2, 3]);
    expect(byKey(model, 'move', 'ArrowDown', true, front)?.at_mm).toEqual([1, 1, 3]);
    expect(byKey(model, 'depth', 'ArrowUp', false, front)?.at_mm).toEqual([1, 2, -2]);
    expect(byKey(model, 'turn', 'ArrowLeft', false, front)?.turn_deg).toEqual([0, -5, 0]);
    expect(byKey(model, 'size', 'ArrowUp', false, front)?.size_mm).toBe(84);
    expect(byKey(model, 'move', 'Enter', false, front)).toBeNull();
  });
});
