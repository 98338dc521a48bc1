// SPDX-License-Identifier: GPL-3.0-or-later
// A tool path as things to be drawn in space: lines by layer with their times, the block that is carved, the tool.
import type { PathDetail, ToolPath } from '../../../machines/toolpath';
import { workBounds, workHeights } from '../../../machines/toolpath';
import type { Curve, MeshData, Vec3 } from '../../../view';
import { layerColours } from './bed_canvas';

/** With more paths than can be drawn, only every so many are. */
const strideFor = (pieces: number, most: number): number => Math.max(1, Math.ceil(pieces / most));

/** Lines apart, one curve for each layer and one for travel, values in seconds from the job's start. */
export function pathCurves(
  toolPath: ToolPath,
  detail: PathDetail | null,
  showTravel: boolean,
  most = Infinity,
): Curve[] {
  const shown = toolPath.paths.flatMap((path, index) => {
    const kept = detail?.kept[index] ?? null;
    const pieces = (kept?.length ?? path.times_s.length) - 1;
    return pieces > 0 && (showTravel || path.kind === 'work') ? [{ path, kept, pieces }] : [];
  });
  const stride = strideFor(
    shown.reduce((sum, { pieces }) => sum + pieces, 0),
    most,
  );
  const groups = new Map<string, typeof shown>();
  for (const [index, one] of shown.entries()) {
    if (index % stride !== 0 && one.pieces < most / 100) continue;
    const layer = one.path.kind === 'travel' ? '' : one.path.layer;
    const group = groups.get(layer);
    if (group) group.push(one);
    else groups.set(layer, [one]);
  }
  return [...groups].map(([layer, group]) => {
    const count = group.reduce((sum, { pieces }) => sum + pieces, 0);
    const positions = new Float32Array(6 * count);
    const values = new Float32Array(2 * count);
    let at = 0;
    for (const { path, kept, pieces } of group)
      for (let i = 0; i < pieces; ++i, ++at)
        for (const end of [0, 1] as const) {
          const point = kept ? (kept[i + end] ?? 0) : i + end;
          for (let k = 0; k < 3; ++k) positions[6 * at + 3 * end + k] = path.points_mm[3 * point + k] ?? 0;
          values[2 * at + end] = path.times_s[point] ?? 0;
        }
    if (layer === '') return { positions, values, separate: true, colour: '--seg-a', widthPx: 1 };
    const colour = layerColours[layer] ?? '--ink';
    const depth = -workHeights(toolPath)[0];
    // Pale at the top, as far as there is a depth: lines that lie close side by side show their heights.
    const blend = { axis: [0, 0, 1] as const, fromMm: -depth, toMm: 0, colour: '--line-2' };
    return { positions, values, separate: true, colour, widthPx: 1, ...(depth > 0 ? { blend } : {}) };
  });
}

/** What the tool works in: its low and high corner; a sheet of no thickness for a laser. Null where nothing is worked. */
export function blockOf(toolPath: ToolPath): readonly [Vec3, Vec3] | null {
  const bounds = workBounds(toolPath);
  if (bounds === null) return null;
  const [low] = workHeights(toolPath);
  return [
    [bounds[0], bounds[1], low],
    [bounds[2], bounds[3], 0],
  ];
}

/** The twelve edges; four where the block has no height. */
export function blockEdges([low, high]: readonly [Vec3, Vec3]): Curve {
  const corner = (i: number): Vec3 => [
    i & 1 ? high[0] : low[0],
    i & 2 ? high[1] : low[1],
    i & 4 ? high[2] : low[2],
  ];
  const edges: number[] = [];
  for (let i = 0; i < 8; ++i)
    for (const bit of [1, 2, 4]) if ((i & bit) === 0) edges.push(...corner(i), ...corner(i | bit));
  return { positions: Float32Array.from(edges), separate: true, colour: '--ink-3', widthPx: 1 };
}

/** The board that everything lies on, a little larger than the block and just below it. */
export function boardUnder([low, high]: readonly [Vec3, Vec3]): MeshData {
  const margin = 0.06 * Math.max(high[0] - low[0], high[1] - low[1], 10);
  const top = low[2] - 0.01 * margin;
  return box(
    [low[0] - margin, low[1] - margin, top - 0.35 * margin],
    [high[0] + margin, high[1] + margin, top],
  );
}

function box(low: Vec3, high: Vec3): MeshData {
  const positions: number[] = [];
  const normals: number[] = [];
  const indices: number[] = [];
  for (let axis = 0; axis < 3; ++axis)
    for (const side of [-1, 1]) {
      const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
      const start = positions.length / 3;
      for (const [a, b] of [
        [0, 0],
        [1, 0],
        [1, 1],
        [0, 1],
      ] as const) {
        const point: [number, number, number] = [0, 0, 0];
        point[axis] = (side > 0 ? high[axis] : low[axis]) ?? 0;
        point[u] = (a ? high[u] : low[u]) ?? 0;
        point[v] = (b ? high[v] : low[v]) ?? 0;
        positions.push(...point);
        normals.push(...[0, 1, 2].map((k) => (k === axis ? side : 0)));
      }
      const corners = side > 0 ? [0, 1, 2, 0, 2, 3] : [0, 2, 1, 0, 3, 2];
      indices.push(...corners.map((corner) => start + corner));
    }
  return {
    positions: Float64Array.from(positions),
    indices: Uint32Array.from(indices),
    normals: Float32Array.from(normals),
  };
}

export interface ToolForm {
  readonly shape: string;
  readonly diameter_mm: number;
  readonly v_angle_degrees: number;
  readonly v_tip_mm: number;
}

/** Its outline from the tip outwards and up the shaft, without the ends on the axis: radius and height, in pairs. */
function profileOf({
  shape,
  diameter_mm,
  v_angle_degrees,
  v_tip_mm,
}: ToolForm): (readonly [number, number])[] {
  const radius = diameter_mm / 2;
  const shaft = 5 * diameter_mm;
  if (shape === 'ball') {
    const steps = 8;
    const arc = Array.from({ length: steps }, (_, i) => (Math.PI / 2) * ((i + 1) / steps));
    return [...arc.map((t) => [radius * Math.sin(t), radius * (1 - Math.cos(t))] as const), [radius, shaft]];
  }
  if (shape === 'v') {
    const tip = Math.min(v_tip_mm / 2, radius);
    const height = (radius - tip) / Math.tan((v_angle_degrees / 2) * (Math.PI / 180));
    return [...(tip > 0 ? [[tip, 0] as const] : []), [radius, height], [radius, height + shaft]];
  }
  return [
    [radius, 0],
    [radius, shaft],
  ];
}

/** The tool with its tip at zero: rings around the axis, closed by a point on it at either end. */
export function toolMesh(form: ToolForm): MeshData {
  const around = 24;
  const profile = profileOf(form);
  const top = profile.at(-1)?.[1] ?? 0;
  const positions: number[] = [0, 0, 0, 0, 0, top];
  const indices: number[] = [];
  for (const [radius, height] of profile)
    for (let i = 0; i < around; ++i) {
      const angle = (2 * Math.PI * i) / around;
      positions.push(radius * Math.cos(angle), radius * Math.sin(angle), height);
    }
  const ring = (row: number, i: number) => 2 + row * around + (i % around);
  for (let i = 0; i < around; ++i) {
    indices.push(0, ring(0, i + 1), ring(0, i));
    for (let row = 0; row + 1 < profile.length; ++row) {
      const [a, b, c, d] = [ring(row, i), ring(row, i + 1), ring(row + 1, i + 1), ring(row + 1, i)];
      indices.push(a, b, c, a, c, d);
    }
    indices.push(1, ring(profile.length - 1, i), ring(profile.length - 1, i + 1));
  }
  return { positions: Float64Array.from(positions), indices: Uint32Array.from(indices) };
}

export const movedTo = (positions: MeshData['positions'], [x, y, z]: Vec3): Float64Array =>
  Float64Array.from(positions, (value, i) => value + (i % 3 === 0 ? x : i % 3 === 1 ? y : z));
