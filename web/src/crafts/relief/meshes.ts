// SPDX-License-Identifier: GPL-3.0-or-later
// From PLY files and reports to what the view draws.
import type { PlyMesh } from '../../jobs/ply';
import type { Report } from '../../jobs/contract';
import type { ColourMapping, MeshData, Plate, Vec3, Viewpoint } from '../../view';
import { figure, vectorOf } from '../common/report';
import type { ShadedMesh } from '../common/shaded_mesh';
import { shadingOf } from '../common/shaded_mesh';

export const errorMapping: ColourMapping = {
  attribute: 'normal_error_deg',
  map: 'error',
  minimum: 0,
  maximum: 75,
  unit: '°',
  label: 'Normal error',
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

const axis = (report: Report, name: string, otherwise: Vec3): Vec3 => vectorOf(report, name) ?? otherwise;

export function plateOf(report: Report, thickness_mm: number): Plate | null {
  const size = vectorOf(report, 'size_mm');
  const centre = vectorOf(report, 'plate_centre_mm');
  if (size === null || centre === null) return null;
  return {
    widthMm: size[0],
    heightMm: size[1],
    thicknessMm: Math.max(0, size[2] - thickness_mm),
    centreMm: centre,
    direction: axis(report, 'direction', [0, 0, -1]),
    up: axis(report, 'up', [0, 1, 0]),
    reliefThicknessMm: thickness_mm,
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

/** A camera as parameters of the relief; a distance typed earlier gives way to the field of view. */
export function parametersOf(camera: Viewpoint): Record<string, string | number | number[] | null> {
  const rounded = (v: Vec3) => v.map((x) => Number(x.toFixed(5)));
  return {
    direction: rounded(camera.direction),
    up: rounded(camera.up),
    projection: camera.projection,
    ...(camera.projection === 'perspective'
      ? {
          field_of_view_deg: Number(Math.min(120, Math.max(0.1, camera.fieldOfViewDeg)).toFixed(2)),
          distance_mm: null,
        }
      : {}),
  };
}
