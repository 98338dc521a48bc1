// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { Vec3, Viewpoint } from '../api';
import {
  type CameraState,
  blended,
  cameraFromViewpoint,
  clipMatrix,
  fitWindow,
  makeScreen,
  orbited,
  panned,
  planePoint,
  projectToPixels,
  projectedBounds,
  rayThroughPixel,
  remeasured,
  sameEye,
  viewpointFromCamera,
  zoomed,
} from './camera';
import { add, along, dot, length, scale, subtract, viewerAxes } from '../vector';

function generator(seed: number): () => number {
  let s = seed;
  return () => {
    s = (Math.imul(s, 1664525) + 1013904223) >>> 0;
    return s / 2 ** 32;
  };
}

const screen = makeScreen(1280, 800, { left: 80, top: 52, right: 312, bottom: 150 });
const viewpoint: Viewpoint = {
  projection: 'perspective',
  direction: [0.3, -0.4, -0.8],
  up: [0.1, 1, 0],
  targetMm: [40, -12, 7],
  distanceMm: 310,
  fieldOfViewDeg: 20,
};
const cameras: [string, CameraState][] = [
  ['perspective', cameraFromViewpoint(viewpoint, 45)],
  ['orthographic', cameraFromViewpoint({ ...viewpoint, projection: 'orthographic' }, 45)],
  [
    'panned and zoomed',
    zoomed(panned(cameraFromViewpoint(viewpoint, 45), screen, 120, -70), screen, 3.7, 300, 500),
  ],
];

/** What the graphics card does with a clip matrix, in single precision where it is single. */
function onCard(camera: CameraState, p: Vec3, origin: Vec3): { x: number; y: number; z: number } {
  const m = clipMatrix(camera, screen, origin, -100, 100).map(Math.fround);
  const q = subtract(p, origin).map(Math.fround) as [number, number, number];
  const row = (r: number): number =>
    (m[r] as number) * q[0] +
    (m[4 + r] as number) * q[1] +
    (m[8 + r] as number) * q[2] +
    (m[12 + r] as number);
  const w = row(3);
  return {
    x: (0.5 + row(0) / w / 2) * screen.width,
    y: (0.5 - row(1) / w / 2) * screen.height,
    z: row(2) / w,
  };
}

describe.each(cameras)('the %s camera', (_name, camera) => {
  const random = generator(7);
  const point = (): Vec3 =>
    add(viewpoint.targetMm, [80 * (random() - 0.5), 80 * (random() - 0.5), 80 * (random() - 0.5)]);

  it('shows a vertex and its copy moved along the ray at the same pixel', () => {
    for (let i = 0; i < 200; ++i) {
      const p = point();
      let moved: Vec3;
      if (camera.kappa > 0) {
        const eye = along(camera.target, camera.forward, -1 / camera.kappa);
        moved = add(eye, scale(subtract(p, eye), 0.7 + 0.6 * random()));
      } else {
        moved = along(p, camera.forward, 60 * (random() - 0.5));
      }
      const a = projectToPixels(camera, screen, p);
      const b = projectToPixels(camera, screen, moved);
      expect(Math.abs((a?.xPx ?? NaN) - (b?.xPx ?? NaN))).toBeLessThan(1e-9);
      expect(Math.abs((a?.yPx ?? NaN) - (b?.yPx ?? NaN))).toBeLessThan(1e-9);
      // On the card, in single precision, still far below a pixel.
      const c = onCard(camera, p, viewpoint.targetMm);
      const d = onCard(camera, moved, viewpoint.targetMm);
      expect(Math.hypot(c.x - d.x, c.y - d.y)).toBeLessThan(0.01);
      expect(Math.hypot(c.x - (a?.xPx ?? NaN), c.y - (a?.yPx ?? NaN))).toBeLessThan(0.01);
    }
  });

  it('finds the pixel again from the ray through it', () => {
    for (let i = 0; i < 50; ++i) {
      const [x, y] = [1280 * random(), 800 * random()];
      const { origin, direction } = rayThroughPixel(camera, screen, x, y, 1000);
      for (const t of [200, 311, 420]) {
        const seen = projectToPixels(camera, screen, along(origin, direction, t));
        expect(seen?.xPx).toBeCloseTo(x, 6);
        expect(seen?.yPx).toBeCloseTo(y, 6);
      }
    }
  });

  it('sorts depth from -1 at the near plane to 1 at the far one', () => {
    const depth = (c: number): number =>
      onCard(camera, along(camera.target, camera.forward, c), viewpoint.targetMm).z;
    expect(depth(-100)).toBeCloseTo(-1, 4);
    expect(depth(100)).toBeCloseTo(1, 4);
    for (let c = -99; c < 100; c += 9) expect(depth(c)).toBeLessThan(depth(c + 1));
  });

  it('keeps a picture when measured from another plane', () => {
    const again = remeasured(camera, add(camera.target, [11, 5, -9]));
    for (let i = 0; i < 20; ++i) {
      const p = point();
      const a = projectToPixels(camera, screen, p);
      const b = projectToPixels(again, screen, p);
      expect(b?.xPx).toBeCloseTo(a?.xPx ?? NaN, 7);
      expect(b?.yPx).toBeCloseTo(a?.yPx ?? NaN, 7);
    }
    expect(sameEye(camera, again, 60)).toBe(true);
  });

  it('turns about a pivot that keeps its pixel, and keeps its axes orthonormal', () => {
    const pivot = point();
    const before = projectToPixels(camera, screen, pivot);
    let turned = camera;
    for (let i = 0; i < 40; ++i)
      turned = orbited(turned, camera.up, pivot, 0.2 * (random() - 0.5), 0.2 * (random() - 0.5));
    const after = projectToPixels(turned, screen, pivot);
    expect(after?.xPx).toBeCloseTo(before?.xPx ?? NaN, 6);
    expect(after?.yPx).toBeCloseTo(before?.yPx ?? NaN, 6);
    expect(dot(turned.right, turned.up)).toBeCloseTo(0, 12);
    expect(dot(turned.right, turned.forward)).toBeCloseTo(0, 12);
    expect(length(turned.up)).toBeCloseTo(1, 12);
    // The turntable keeps the horizon level.
    expect(dot(turned.right, camera.up)).toBeCloseTo(0, 9);
    expect(sameEye(camera, turned, 60)).toBe(false);
  });

  it('blends from one end to the other, through rotations', () => {
    const other = orbited(camera, camera.up, viewpoint.targetMm, 1.1, -0.4);
    const p = point();
    for (const [t, end] of [
      [0, other],
      [1, camera],
    ] as const) {
      const a = projectToPixels(blended(other, camera, viewpoint.targetMm, t), screen, p);
      const b = projectToPixels(end, screen, p);
      expect(a?.xPx).toBeCloseTo(b?.xPx ?? NaN, 6);
      expect(a?.yPx).toBeCloseTo(b?.yPx ?? NaN, 6);
    }
    const half = blended(other, camera, viewpoint.targetMm, 0.5);
    expect(dot(half.right, half.forward)).toBeCloseTo(0, 12);
    expect(dot(half.forward, other.forward)).toBeCloseTo(dot(half.forward, camera.forward), 12);
  });
});

describe('viewpoints', () => {
  it('come back from the camera they made', () => {
    const camera = cameraFromViewpoint(viewpoint, 45);
    const back = viewpointFromCamera(camera, screen, viewpoint.targetMm, 310);
    const axes = viewerAxes(viewpoint.direction, viewpoint.up);
    expect(back.projection).toBe('perspective');
    back.direction.forEach((x, k) => expect(x).toBeCloseTo(axes.forward[k] as number, 12));
    back.up.forEach((x, k) => expect(x).toBeCloseTo(axes.up[k] as number, 12));
    back.targetMm.forEach((x, k) => expect(x).toBeCloseTo(viewpoint.targetMm[k] as number, 9));
    expect(back.distanceMm).toBeCloseTo(310, 9);
    const width = (90 * screen.free.width) / screen.free.height;
    expect(back.fieldOfViewDeg).toBeCloseTo((2 * Math.atan(width / 2 / 310) * 180) / Math.PI, 9);
  });

  it('taken from a camera after orbiting and panning show the same picture', () => {
    const camera = panned(
      orbited(cameraFromViewpoint(viewpoint, 45), [0, 1, 0], [30, 0, 0], 0.7, 0.2),
      screen,
      55,
      31,
    );
    const taken = viewpointFromCamera(camera, screen, [44, -10, 3], 310);
    expect(sameEye(cameraFromViewpoint(taken, 45), camera, 60)).toBe(true);
  });

  it('very far away agree with the orthographic picture', () => {
    const near = cameraFromViewpoint({ ...viewpoint, distanceMm: 1e9 }, 45);
    const far = cameraFromViewpoint({ ...viewpoint, projection: 'orthographic' }, 45);
    const p: Vec3 = [60, 3, -20];
    const a = projectToPixels(near, screen, p);
    const b = projectToPixels(far, screen, p);
    expect(Math.hypot((a?.xPx ?? NaN) - (b?.xPx ?? NaN), (a?.yPx ?? NaN) - (b?.yPx ?? NaN))).toBeLessThan(
      1e-4,
    );
    // Single precision on the card loses nothing more, however far the eye.
    const c = onCard(near, p, viewpoint.targetMm);
    expect(Math.hypot(c.x - (a?.xPx ?? NaN), c.y - (a?.yPx ?? NaN))).toBeLessThan(1e-2);
  });

  it('at or behind the eye have no pixel', () => {
    const camera = cameraFromViewpoint(viewpoint, 45);
    expect(projectToPixels(camera, screen, along(camera.target, camera.forward, -310))).toBeNull();
    expect(projectToPixels(camera, screen, along(camera.target, camera.forward, -400))).toBeNull();
  });
});

describe('framing', () => {
  it('puts the object into the free rectangle with its margin, touching two sides, and leaves the eye alone', () => {
    const random = generator(3);
    const points = Float32Array.from({ length: 300 }, () => 70 * (random() - 0.5));
    for (const camera of [
      cameraFromViewpoint(viewpoint, 45),
      cameraFromViewpoint({ ...viewpoint, projection: 'orthographic' }, 45),
    ]) {
      const bounds = projectedBounds(camera, points, viewpoint.targetMm);
      expect(bounds).not.toBeNull();
      if (!bounds) return;
      const fitted = fitWindow(camera, screen, bounds, 16);
      expect(sameEye(camera, fitted, 60)).toBe(true);
      let [left, right, top, bottom] = [Infinity, -Infinity, Infinity, -Infinity];
      for (let i = 0; i < points.length; i += 3) {
        const p = projectToPixels(
          fitted,
          screen,
          add(viewpoint.targetMm, [points[i] as number, points[i + 1] as number, points[i + 2] as number]),
        );
        left = Math.min(left, p?.xPx ?? NaN);
        right = Math.max(right, p?.xPx ?? NaN);
        top = Math.min(top, p?.yPx ?? NaN);
        bottom = Math.max(bottom, p?.yPx ?? NaN);
      }
      const { free } = screen;
      const slack = [
        left - free.left,
        free.left + free.width - right,
        top - free.top,
        free.top + free.height - bottom,
      ];
      for (const s of slack) expect(s).toBeGreaterThan(16 - 1e-6);
      expect(slack.filter((s) => Math.abs(s - 16) < 1e-6).length).toBeGreaterThanOrEqual(2);
    }
  });

  it('zooms about a pixel that keeps its place', () => {
    const camera = cameraFromViewpoint(viewpoint, 45);
    const before = planePoint(camera, screen, 300, 410);
    const after = planePoint(zoomed(camera, screen, 2.5, 300, 410), screen, 300, 410);
    expect(after[0]).toBeCloseTo(before[0], 10);
    expect(after[1]).toBeCloseTo(before[1], 10);
  });

  it('keeps a usable free rectangle when panels would take everything', () => {
    const crowded = makeScreen(390, 300, { left: 300, top: 0, right: 300, bottom: 290 });
    expect(crowded.free.width).toBeGreaterThanOrEqual(78);
    expect(crowded.free.height).toBeGreaterThanOrEqual(60);
    expect(crowded.free.left).toBeGreaterThanOrEqual(0);
    expect(crowded.free.left + crowded.free.width).toBeLessThanOrEqual(390);
    expect(crowded.free.top + crowded.free.height).toBeLessThanOrEqual(300);
  });
});
