// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { Vec3 } from '../api';
import { add, dot, normalise, scale, viewerAxes } from '../vector';
import { DEFAULT_LIGHT, towardsLight } from './light';
import { FILL, fillLight, lightAtPoint, type Lights } from './lighting';

/** The rooms' viewpoints: relief, zippable, thermoform. */
const viewpoints: readonly (readonly [direction: Vec3, up: Vec3])[] = [
  [
    [0, 0, -1],
    [0, 1, 0],
  ],
  [
    [-0.35, -0.3, -1],
    [0, 1, 0],
  ],
  [
    [0.14, 0.95, -0.98],
    [0, 0, 1],
  ],
];

/** To the 6 faces and 8 corners of a cube. */
const fourteen: readonly Vec3[] = [-1, 0, 1]
  .flatMap((x) => [-1, 0, 1].flatMap((y) => [-1, 0, 1].map((z): Vec3 => [x, y, z])))
  .filter((d) => [1, 3].includes(dot(d, d)))
  .map((d) => normalise(d));

const luminance = (light: Vec3): number => dot(light, [0.2126, 0.7152, 0.0722]);

function lightsSeenFrom(
  towardsViewer: Vec3,
  [direction, up]: readonly [Vec3, Vec3],
  filled: boolean,
): Lights {
  const frame = viewerAxes(direction, up);
  const towardsKey = towardsLight(DEFAULT_LIGHT, frame);
  const camera = viewerAxes(scale(towardsViewer, -1), up);
  const fill = fillLight(towardsKey, camera);
  return {
    towardsKey,
    up: frame.up,
    front: scale(frame.forward, -1),
    fill: filled ? fill : { ...fill, strength: 0 },
  };
}

/** Of the disc that a white sphere is seen as, from far away: mean, and its darkest and brightest tenth. */
function discSeenFrom(towardsViewer: Vec3, viewpoint: readonly [Vec3, Vec3], filled = true) {
  const lights = lightsSeenFrom(towardsViewer, viewpoint, filled);
  const { right, up } = viewerAxes(scale(towardsViewer, -1), viewpoint[1]);
  const values: number[] = [];
  for (let i = -19.5; i < 20; ++i)
    for (let j = -19.5; j < 20; ++j) {
      const [x, y] = [i / 20, j / 20];
      const z = Math.sqrt(1 - x * x - y * y);
      if (!(z >= 0)) continue;
      const normal = add(add(scale(right, x), scale(up, y)), scale(towardsViewer, z));
      values.push(luminance(lightAtPoint(normal, towardsViewer, lights)));
    }
  values.sort((a, b) => a - b);
  const tenth = Math.floor(values.length / 10);
  const mean = (of: number[]) => of.reduce((sum, value) => sum + value, 0) / of.length;
  return { mean: mean(values), darkest: mean(values.slice(0, tenth)), brightest: mean(values.slice(-tenth)) };
}

/** Mean luminance of the darkest of the views, and how many times brighter the brightest is. */
function darkestView(viewpoint: readonly [Vec3, Vec3], filled: boolean) {
  const means = fourteen.map((from) => discSeenFrom(from, viewpoint, filled).mean);
  return { mean: Math.min(...means), ratio: Math.max(...means) / Math.min(...means) };
}

describe('a white sphere seen from the faces and corners of a cube', () => {
  it.each(viewpoints)('is at most 1.6 times brighter on one side than on another: %j', (...viewpoint) => {
    const { mean, ratio } = darkestView(viewpoint, true);
    expect(ratio).toBeLessThan(1.6);
    expect(mean).toBeGreaterThan(0.45);
  });

  it.each(viewpoints)('would be more than 2.5 times without the fill light: %j', (...viewpoint) => {
    expect(darkestView(viewpoint, false).ratio).toBeGreaterThan(2.5);
  });

  it.each(viewpoints)(
    'has form from every side, a tenth at least 1.35 times as bright as another: %j',
    (...viewpoint) => {
      for (const from of fourteen) {
        const { darkest, brightest } = discSeenFrom(from, viewpoint);
        expect(brightest / darkest).toBeGreaterThan(1.35);
      }
    },
  );
});

describe('the fill light', () => {
  const viewpoint = viewpoints[0] as (typeof viewpoints)[0];
  it('leaves the picture from the viewpoint to the key light', () => {
    expect(lightsSeenFrom([0, 0, 1], viewpoint, true).fill.strength).toBeLessThan(0.05 * FILL);
  });

  it('is all there where one looks straight against the key light', () => {
    const towardsKey = normalise([0.3, 0.5, 0.8]);
    expect(fillLight(towardsKey, viewerAxes(towardsKey, [0, 1, 0])).strength).toBeCloseTo(FILL, 12);
  });

  it('comes from above the viewer, on the side away from the key light', () => {
    const camera = viewerAxes([0, 0, -1], [0, 1, 0]);
    const { towards } = fillLight(normalise([-1, 0, -1]), camera);
    expect(towards[0]).toBeGreaterThan(0.1);
    expect(towards[1]).toBeGreaterThan(0.3);
    expect(towards[2]).toBeGreaterThan(0.8);
  });
});
