// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { Vec3 } from '../api';
import { plateDimensions } from '../overlay/dimensions';
import { dotOf, lightAt, spokenLight, towardsLight } from '../render/light';
import { isClosed, shadingFor, smoothNormals, updateNormals } from './normals';
import { plateBody, plateCorners, plateFrame, plateFront } from '../overlay/plate';
import { cutOutline } from '../overlay/section';
import { supportOf } from './support';
import { swipeRange } from '../overlay/swipe_divider';
import { dot, viewerAxes } from '../vector';

/** Length of an outline of pieces, two points each, and the area that it encloses in the plane (holes taken off). */
function outlineMeasures(pieces: Float32Array, normal: Vec3): { length: number; area: number } {
  let length = 0;
  let twice = 0;
  for (let i = 0; i + 5 < pieces.length; i += 6) {
    const [ax, ay, az, bx, by, bz] = pieces.subarray(i, i + 6) as unknown as [...Vec3, ...Vec3];
    length += Math.hypot(bx - ax, by - ay, bz - az);
    twice +=
      normal[0] * (ay * bz - az * by) + normal[1] * (az * bx - ax * bz) + normal[2] * (ax * by - ay * bx);
  }
  return { length, area: Math.abs(twice) / 2 };
}

/** A sphere of latitude and longitude, poles shared. */
function sphere(n: number, m: number, radius = 1): { positions: Float64Array; indices: Uint32Array } {
  const positions: number[] = [0, radius, 0];
  for (let i = 1; i < n; ++i) {
    for (let j = 0; j < m; ++j) {
      const [u, v] = [(Math.PI * i) / n, (2 * Math.PI * j) / m];
      positions.push(
        radius * Math.sin(u) * Math.sin(v),
        radius * Math.cos(u),
        radius * Math.sin(u) * Math.cos(v),
      );
    }
  }
  positions.push(0, -radius, 0);
  const at = (i: number, j: number): number =>
    i === 0 ? 0 : i === n ? positions.length / 3 - 1 : 1 + (i - 1) * m + (j % m);
  const indices: number[] = [];
  for (let i = 0; i < n; ++i) {
    for (let j = 0; j < m; ++j) {
      if (i > 0) indices.push(at(i, j), at(i + 1, j), at(i, j + 1));
      if (i < n - 1) indices.push(at(i, j + 1), at(i + 1, j), at(i + 1, j + 1));
    }
  }
  return { positions: Float64Array.from(positions), indices: Uint32Array.from(indices) };
}

const cube = {
  positions: Float64Array.of(0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1),
  // prettier-ignore
  indices: Uint32Array.of(0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7),
};

describe('normals', () => {
  it('of a sphere are its radii to the mesh’s order, and no vertex is split', () => {
    let last = Infinity;
    for (const n of [12, 24, 48]) {
      const mesh = sphere(n, 2 * n);
      const shading = shadingFor(mesh.positions, mesh.indices);
      expect(shading.source.length).toBe(mesh.positions.length / 3);
      let worst = 0;
      for (let i = 0; i < mesh.positions.length; i += 3) {
        const d = [0, 1, 2].map(
          (k) => (shading.normals[i + k] as number) - (mesh.positions[i + k] as number),
        );
        worst = Math.max(worst, Math.hypot(...d));
      }
      expect(worst).toBeLessThan(0.6 * last);
      last = worst;
    }
  });

  it('of a cube are those of its faces: every corner is drawn three times', () => {
    const shading = shadingFor(cube.positions, cube.indices);
    expect(shading.source.length).toBe(24);
    for (let t = 0; t < cube.indices.length; t += 3) {
      for (let k = 0; k < 3; ++k) {
        const drawn = shading.indices[t + k] as number;
        expect(shading.source[drawn]).toBe(cube.indices[t + k]);
        const n = [...shading.normals.subarray(3 * drawn, 3 * drawn + 3)];
        expect(Math.max(...n.map(Math.abs))).toBeCloseTo(1, 6);
      }
    }
  });

  it('follow positions that moved', () => {
    const mesh = sphere(16, 32);
    const shading = shadingFor(mesh.positions, mesh.indices);
    const flat = mesh.positions.map((x, i) => (i % 3 === 2 ? 0.1 * x : x));
    updateNormals(shading, flat, mesh.indices);
    expect([...shading.normals]).toEqual([...smoothNormals(flat, mesh.indices, flat.length / 3)]);
  });

  it('never become NaN where triangles have no area', () => {
    const shading = shadingFor(new Float64Array(9), Uint32Array.of(0, 1, 2));
    expect([...shading.normals].every(Number.isFinite)).toBe(true);
  });

  it('tell closed meshes from open ones', () => {
    const mesh = sphere(8, 12);
    expect(isClosed(mesh.indices, mesh.positions.length / 3)).toBe(true);
    expect(isClosed(mesh.indices.subarray(3), mesh.positions.length / 3)).toBe(false);
    expect(isClosed(new Uint32Array(0), 0)).toBe(false);
  });
});

describe('cuts', () => {
  it('of a sphere approach a circle in length and area, at second order', () => {
    const errors = [16, 32, 64].map((n) => {
      const mesh = sphere(n, 2 * n, 2);
      const h = 0.37;
      const { length, area } = outlineMeasures(
        cutOutline(mesh.positions, mesh.indices, [0.6, 0.8, 0], h),
        [0.6, 0.8, 0],
      );
      const r = Math.sqrt(4 - h * h);
      return [Math.abs(length - 2 * Math.PI * r), Math.abs(area - Math.PI * r * r)] as const;
    });
    for (const k of [0, 1] as const) {
      const order = Math.log2((errors[0]?.[k] ?? NaN) / (errors[2]?.[k] ?? NaN)) / 2;
      expect(order).toBeGreaterThan(1.7);
    }
  });

  it('through vertices stay closed', () => {
    const pieces = cutOutline(cube.positions, cube.indices, [1, 0, 0], 1);
    const { area } = outlineMeasures(pieces, [1, 0, 0]);
    expect(area).toBeCloseTo(1, 12);
  });

  it('beside the mesh are empty', () => {
    expect(cutOutline(cube.positions, cube.indices, [1, 0, 0], 2)).toHaveLength(0);
  });
});

describe('plates', () => {
  const plate = { widthMm: 120, heightMm: 80, thicknessMm: 3, centreMm: [5, 6, 7] as Vec3 };
  const view = { direction: [1, -1, 0.5] as Vec3, up: [0, 0, 1] as Vec3 };

  it('stand perpendicular to the looking direction, centred, in their size', () => {
    const frame = plateFrame(plate, view);
    const corners = plateCorners(frame);
    const axes = viewerAxes(view.direction, view.up);
    for (const c of corners) expect(dot([c[0] - 5, c[1] - 6, c[2] - 7], axes.forward)).toBeCloseTo(0, 10);
    expect(
      Math.hypot(...[0, 1, 2].map((k) => (corners[1][k] as number) - (corners[0][k] as number))),
    ).toBeCloseTo(120, 10);
    expect(
      Math.hypot(...[0, 1, 2].map((k) => (corners[3][k] as number) - (corners[0][k] as number))),
    ).toBeCloseTo(80, 10);
  });

  it('enclose width x height x thickness with faces outward', () => {
    const frame = plateFrame(plate, view);
    const body = plateBody(frame);
    let six = 0;
    for (const part of [plateFront(frame), body]) {
      if (!part) continue;
      const p = (v: number): Vec3 =>
        [0, 1, 2].map(
          (k) => (part.positions[3 * v + k] as number) - (frame.centre[k] as number),
        ) as unknown as Vec3;
      for (let t = 0; t < part.indices.length; t += 3) {
        const [a, b, c] = [0, 1, 2].map((k) => p(part.indices[t + k] as number)) as [Vec3, Vec3, Vec3];
        six +=
          a[0] * (b[1] * c[2] - b[2] * c[1]) +
          a[1] * (b[2] * c[0] - b[0] * c[2]) +
          a[2] * (b[0] * c[1] - b[1] * c[0]);
      }
    }
    expect(six / 6).toBeCloseTo(120 * 80 * 3, 6);
    expect(plateBody({ ...frame, thickness: 0 })).toBeNull();
  });

  it('have their dimension lines outside, level and reading downwards', () => {
    const corners = [
      [100, 400],
      [700, 400],
      [700, 90],
      [100, 90],
    ].map(([xPx, yPx]) => ({ xPx, yPx })) as never;
    const { width, height } = plateDimensions(corners);
    expect(width).toMatchObject({ from: { xPx: 100, yPx: 426 }, to: { xPx: 700, yPx: 426 }, angleDeg: 0 });
    expect(height?.label.xPx).toBe(720);
    expect(height?.angleDeg).toBeCloseTo(90, 12);
  });
});

describe('light', () => {
  const axes = viewerAxes([0, 0, -1], [0, 1, 0]);

  it('comes from where the dot stands, and the dot stands where it comes from', () => {
    for (let azimuthDeg = 0; azimuthDeg < 360; azimuthDeg += 45) {
      for (const elevationDeg of [10, 35, 60]) {
        const [x, y] = dotOf({ azimuthDeg, elevationDeg });
        expect(lightAt(x, y, { azimuthDeg: 1, elevationDeg: 1 })).toMatchObject({ azimuthDeg, elevationDeg });
        const l = towardsLight({ azimuthDeg, elevationDeg }, axes);
        expect(l[0]).toBeCloseTo(x, 12);
        expect(l[1]).toBeCloseTo(y, 12);
        expect(l[2]).toBeCloseTo(Math.sin((elevationDeg * Math.PI) / 180), 12);
      }
    }
  });

  it('is spoken', () => {
    expect(spokenLight({ azimuthDeg: 135, elevationDeg: 35 })).toBe('from the upper left, 35 degrees high');
    expect(spokenLight({ azimuthDeg: -1, elevationDeg: 20 })).toBe('from the right, 20 degrees high');
    expect(spokenLight({ azimuthDeg: 12, elevationDeg: 90 })).toBe('from the viewer, 90 degrees high');
  });
});

describe('outlines', () => {
  it('keep the extremes of the box exactly and nearly all of any other direction', () => {
    const { positions } = sphere(120, 240, 3);
    const points = Float32Array.from(positions, (x, i) => (i % 3 === 0 ? 2 * x : x));
    const support = supportOf(points);
    expect(support.max[0]).toBeCloseTo(6, 2);
    expect(support.points.length).toBeLessThan(3 * 110);
    for (const d of [
      [0.6, 0.8, 0],
      [0.5, -0.5, 0.707],
      [-0.3, 0.2, -0.93],
    ] as Vec3[]) {
      const furthest = (p: Float32Array): number => {
        let best = -Infinity;
        for (let i = 0; i < p.length; i += 3)
          best = Math.max(
            best,
            d[0] * (p[i] as number) + d[1] * (p[i + 1] as number) + d[2] * (p[i + 2] as number),
          );
        return best;
      };
      expect(furthest(support.points)).toBeGreaterThan(0.97 * furthest(points));
    }
  });

  it('leave the divider within reach', () => {
    expect(swipeRange({ left: 100, right: 700, top: 0, bottom: 1 }, 800)).toEqual({ from: 100, length: 600 });
    const beyond = swipeRange({ left: -500, right: 3000, top: 0, bottom: 1 }, 800);
    expect(beyond.from).toBeGreaterThan(0);
    expect(beyond.from + beyond.length).toBeLessThan(800);
    const gone = swipeRange({ left: 2000, right: 2400, top: 0, bottom: 1 }, 800);
    expect(gone.from).toBeLessThan(800);
  });
});
