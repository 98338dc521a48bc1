// SPDX-License-Identifier: GPL-3.0-or-later
// From PLY files and reports to what the view draws.
import type { PlyMesh } from '../../jobs/ply';
import type { Report } from '../../jobs/contract';
import type { ColourMapping, MeshData, Plate, Vec3, Viewpoint } from '../../view';
import { along, viewerAxes } from '../../view/vector';
import { figure, vectorOf } from '../../shared/session/report';
import type { ShadedMesh } from '../../shared/panels/shaded_mesh';
import { shadingOf } from '../../shared/panels/shaded_mesh';
import type { PlateAxes } from './base/base_place';
import { brightnessMapping } from './light/light_values';
import type { LitRelief } from './shown';

export const errorMapping: ColourMapping = {
  attribute: 'normal_error_deg',
  map: 'error',
  minimum: 0,
  maximum: 75,
  unit: '°',
  label: 'Shading difference',
};

/** The error is known where the viewer sees the surface. */
export function errorOf(mesh: PlyMesh): Float32Array {
  const error = mesh.attributes['normal_error_deg'] ?? new Float32Array(mesh.positions.length / 3);
  const visible = mesh.attributes['visible'];
  return visible ? error.map((value, i) => (visible[i] ? value : NaN)) : error;
}

export const reliefData = (mesh: ShadedMesh): MeshData => ({
  positions: mesh.positions,
  indices: mesh.indices,
  ...shadingOf(mesh),
  attributes: { [errorMapping.attribute]: errorOf(mesh) },
});

/** Light is drawn as it is, so that one normal does for all. */
export const litData = ({ positions, indices, brightness, of }: LitRelief): MeshData => {
  const [x, y, z] = axis(of.report, 'direction', [0, 0, -1]);
  const normals = new Float32Array(positions.length);
  for (let i = 0; i < normals.length; i += 3) normals.set([-x, -y, -z], i);
  return { positions, indices, normals, attributes: { [brightnessMapping.attribute]: brightness } };
};

const axis = (report: Report, name: string, otherwise: Vec3): Vec3 => vectorOf(report, name) ?? otherwise;

/** A flat plate as the operation writes it is a box. */
const boxTriangles = 12;

/** What `base.ply` holds beyond a flat plate; null where it is one, which is drawn without a file. */
export const baseOf = ({ positions, indices }: PlyMesh): MeshData | null =>
  indices.length > 3 * boxTriangles ? { positions, indices } : null;

/** Where the plate lies in the scene. */
export function plateAxesOf(report: Report): PlateAxes | null {
  const middleMm = vectorOf(report, 'plate_centre_mm');
  if (middleMm === null) return null;
  const { right, up, forward } = viewerAxes(
    axis(report, 'direction', [0, 0, -1]),
    axis(report, 'up', [0, 1, 0]),
  );
  return { middleMm, right, up, towards: [-forward[0], -forward[1], -forward[2]] };
}

/** `base`: drawn instead of a flat plate. */
export function plateOf(report: Report, thickness_mm: number, base: MeshData | null = null): Plate | null {
  const size = vectorOf(report, 'size_mm');
  const centre = vectorOf(report, 'plate_centre_mm');
  if (size === null || centre === null) return null;
  // Painted places may stand out farther than the rest.
  const standsOut_mm = figure(report, 'stands_out_max_mm') ?? thickness_mm;
  return {
    widthMm: size[0],
    heightMm: size[1],
    thicknessMm: Math.max(0, size[2] - standsOut_mm),
    centreMm: centre,
    direction: axis(report, 'direction', [0, 0, -1]),
    up: axis(report, 'up', [0, 1, 0]),
    reliefThicknessMm: standsOut_mm,
    ...(base ? { mesh: base } : {}),
  };
}

export function viewpointOf(report: Report, fieldOfViewDeg: number): Viewpoint | null {
  const centre = vectorOf(report, 'plate_centre_mm');
  if (centre === null) return null;
  const distance = figure(report, 'distance_mm');
  const width = vectorOf(report, 'size_mm')?.[0] ?? 100;
  return {
    projection: distance === null ? 'orthographic' : 'perspective',
    direction: axis(report, 'direction', [0, 0, -1]),
    up: axis(report, 'up', [0, 1, 0]),
    targetMm: centre,
    distanceMm: distance ?? width / (2 * Math.tan((fieldOfViewDeg * Math.PI) / 360)),
    fieldOfViewDeg,
  };
}

/** A camera as parameters of the relief; a distance typed earlier gives way to the field of view. `positions` times
 *  `scale` is the model as it is drawn, mm. */
export function parametersOf(
  camera: Viewpoint,
  positions: ArrayLike<number>,
  scale: number,
): Record<string, string | number | number[] | null> {
  const rounded = (v: Vec3) => v.map((x) => Number(x.toFixed(5)));
  return {
    direction: rounded(camera.direction),
    up: rounded(camera.up),
    projection: camera.projection,
    ...(camera.projection === 'perspective'
      ? { field_of_view_deg: Number(fieldOfViewDeg(camera, positions, scale).toFixed(2)), distance_mm: null }
      : {}),
  };
}

/** The angle that the parameter means: under which the model's width is seen, on the plane through the middle of its depth, from an eye
 *  before the middle of its picture. Zoom and the window's shape do not matter. */
function fieldOfViewDeg(camera: Viewpoint, positions: ArrayLike<number>, scale: number): number {
  const { right, up, forward } = viewerAxes(camera.direction, camera.up);
  const [ex, ey, ez] = along(camera.targetMm, forward, -camera.distanceMm).map((mm) => mm / scale) as [
    number,
    number,
    number,
  ];
  const local = (i: number, axis: Vec3) =>
    (at(positions, i) - ex) * axis[0] +
    (at(positions, i + 1) - ey) * axis[1] +
    (at(positions, i + 2) - ez) * axis[2];
  let [front, back] = [Infinity, -Infinity];
  for (let i = 0; i + 2 < positions.length; i += 3) {
    const depth = local(i, forward);
    front = Math.min(front, depth);
    back = Math.max(back, depth);
  }
  const distance = 0.5 * (front + back);
  let [x, y, width] = [0, 0, 0];
  for (let pass = 0; pass < passes; ++pass) {
    let [left, rightmost, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
    for (let i = 0; i + 2 < positions.length; i += 3) {
      const towards = distance / local(i, forward);
      const a = (local(i, right) - x) * towards;
      const b = (local(i, up) - y) * towards;
      left = Math.min(left, a);
      rightmost = Math.max(rightmost, a);
      low = Math.min(low, b);
      high = Math.max(high, b);
    }
    width = rightmost - left;
    const [dx, dy] = [0.5 * (left + rightmost), 0.5 * (low + high)];
    x += dx;
    y += dy;
    if (Math.abs(dx) + Math.abs(dy) < 1e-6 * width) break;
  }
  // An eye within the model has no such angle: the operation says so of the widest one.
  if (!(front > 0) || !Number.isFinite(width)) return widest_deg;
  const angle = (2 * Math.atan((0.5 * width) / distance) * 180) / Math.PI;
  return Math.min(widest_deg, Math.max(0.1, angle));
}

const passes = 12;
const widest_deg = 120;
const at = (values: ArrayLike<number>, i: number): number => values[i] ?? 0;
