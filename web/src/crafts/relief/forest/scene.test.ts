// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { Pillar, Scene, Viewpoint } from './scene';
import {
  addedCorner,
  addPillar,
  addViewpoint,
  changePillar,
  cornersOf,
  distanceOf,
  movedCorner,
  movedEnd,
  movedPillar,
  outlinedPillar,
  placeOf,
  readScene,
  removedCorner,
  removePillar,
  removeViewpoint,
  sceneBytes,
  shapedPillar,
  turnedTo,
  widenedPillar,
  widthOf,
  withSource,
} from './scene';

const front: Viewpoint = {
  eye_mm: [0, -600, 60],
  look_at_mm: [0, 0, 50],
  width_mm: 70,
  sample: 'bust',
  vertices: 2000,
  direction: [0, 0, -1],
  up: [0, 1, 0],
};
const square: Pillar = {
  shape: 'square',
  x_mm: 10,
  y_mm: -40,
  width_mm: 12,
  turn_deg: 30,
  height_mm: 120,
};
const outlined: Pillar = {
  outline_mm: [
    [0, 0],
    [20, 0],
    [20, 10],
    [0, 10],
  ],
  height_mm: 90,
};
const scene: Scene = { viewpoints: [front], pillars: [square, outlined] };

describe('pillars', () => {
  it('are moved by their middle, to tenths of a millimetre', () => {
    expect(placeOf(outlined)).toEqual([10, 5]);
    expect(movedPillar(outlined, [11.04, 5])).toMatchObject({
      outline_mm: [
        [1, 0],
        [21, 0],
        [21, 10],
        [1, 10],
      ],
    });
    expect(movedPillar(square, [1.26, 2])).toEqual({ ...square, x_mm: 1.3, y_mm: 2 });
  });

  it('become wider about their middle', () => {
    expect(widenedPillar(square, 20)).toEqual({ ...square, width_mm: 20 });
    expect(widenedPillar(outlined, 0)).toEqual(outlined); // nothing could be widened again
    const wide = widenedPillar(outlined, 40);
    expect(widthOf(wide)).toBe(40);
    expect(placeOf(wide)).toEqual([10, 5]);
  });

  it('take a shape with a name where they stand', () => {
    expect(shapedPillar(square, 'round')).toEqual({ ...square, shape: 'round' });
    expect(shapedPillar(outlined, 'hexagon')).toEqual({
      shape: 'hexagon',
      x_mm: 10,
      y_mm: 5,
      width_mm: 20,
      height_mm: 90,
    });
  });

  it('are added where they stand free, and taken away', () => {
    let many = scene;
    for (let k = 0; k < 12; ++k) many = addPillar(many, 0, square);
    expect(many.pillars).toHaveLength(14);
    const places = many.pillars.map(placeOf);
    // The squares' corners reach 8.5 mm from their middles.
    for (const [i, [x, y]] of places.entries())
      for (const [a, b] of places.slice(i + 1)) expect(Math.hypot(x - a, y - b)).toBeGreaterThan(17);
    expect(removePillar(many, 0).pillars).toEqual(many.pillars.slice(1));
    expect(addPillar({ ...scene, pillars: [] }, null, square).pillars).toEqual([
      { ...square, x_mm: 0, y_mm: 0 },
    ]);
  });

  it('change alone', () => {
    const changed = changePillar(scene, 1, (pillar) => ({ ...pillar, height_mm: 50 }));
    expect(changed.pillars).toEqual([square, { ...outlined, height_mm: 50 }]);
    expect(changed.viewpoints).toBe(scene.viewpoints);
  });
});

describe('viewpoints', () => {
  it('keep their height and their distance', () => {
    expect(movedEnd(front, 'eye_mm', [5, -500])).toMatchObject({ eye_mm: [5, -500, 60] });
    const turned = turnedTo(front, [30, 0]);
    expect(turned.eye_mm).toEqual([600, 0, 60]);
    expect(distanceOf(turned)).toBe(600);
  });

  it('forget how the model before was turned', () => {
    expect(withSource(front, { model: 2 })).toEqual({
      eye_mm: [0, -600, 60],
      look_at_mm: [0, 0, 50],
      width_mm: 70,
      model: 2,
    });
  });

  it('are added in the widest gap, and taken away', () => {
    const two = addViewpoint(scene, 0);
    expect(two.viewpoints[1]).toMatchObject({ eye_mm: [0, 600, 60], sample: 'bust' });
    const [first, second] = [addViewpoint(two, null).viewpoints[2], removeViewpoint(two, 0)];
    expect(Math.abs(first?.eye_mm[0] ?? 0)).toBe(600);
    expect(second.viewpoints).toEqual([two.viewpoints[1]]);
  });
});

it('a scene is the same after it was written and read', () => {
  expect(readScene(sceneBytes(scene))).toEqual(scene);
});

it('turns a shape into an outline of its own, whose corners are changed', () => {
  const own = outlinedPillar(square);
  expect(cornersOf(own)).toHaveLength(4);
  for (const [x, y] of cornersOf(own)) expect(Math.hypot(x - 10, y + 40)).toBeCloseTo(6 * Math.SQRT2, 1);
  // Counter-clockwise, as the core reads outlines.
  const area = cornersOf(own).reduce((sum, [x, y], k, all) => {
    const [a, b] = all[(k + 1) % all.length] ?? [0, 0];
    return sum + (x * b - a * y) / 2;
  }, 0);
  expect(area).toBeCloseTo(144, 0);
  expect(cornersOf(outlinedPillar({ ...square, shape: 'hexagon' }))).toHaveLength(6);
  expect(outlinedPillar(outlined)).toBe(outlined);

  expect(cornersOf(movedCorner(own, 2, [1.26, 3]))[2]).toEqual([1.3, 3]);
  const more = addedCorner(own, 3);
  expect(cornersOf(more)).toHaveLength(5);
  const [a, , , d, between] = cornersOf(more);
  expect(between?.[0]).toBeCloseTo(((a?.[0] ?? 0) + (d?.[0] ?? 0)) / 2, 1);
  const triangle = removedCorner(own, 0);
  expect(cornersOf(triangle)).toHaveLength(3);
  expect(removedCorner(triangle, 0)).toBe(triangle);
});
