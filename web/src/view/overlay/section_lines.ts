// SPDX-License-Identifier: GPL-3.0-or-later
// The maker's section as a plane, and the lines of a picture: curves as given, outlines of the cut.
import type { Curve, Section, Vec3, Viewpoint } from '../api';
import type { LineStyle } from './lines';
import { piecesOf, pieceValues } from './lines';
import { cutOutline } from './section';
import type { PartName } from '../render/part';
import type { Lines } from '../render/picture';
import type { Stage } from '../render/stage';
import { resolveColour } from '../theme';
import { dot, normalise, scale, viewerAxes } from '../vector';

export interface Plane {
  normal: Vec3;
  offset: number;
}

/** Kept is normal . p <= offset. */
export function sectionPlane(section: Section, viewpoint: Pick<Viewpoint, 'direction' | 'up'>): Plane {
  const named = {
    x: [1, 0, 0],
    y: [0, 1, 0],
    z: [0, 0, 1],
    view: viewerAxes(viewpoint.direction, viewpoint.up).right,
  } as const;
  const axis = normalise(typeof section.axis === 'string' ? named[section.axis] : section.axis, [1, 0, 0]);
  const sign = section.flipped ? -1 : 1;
  return { normal: scale(axis, sign), offset: sign * section.positionMm };
}

function blendOf(
  { axis, fromMm, toMm, colour }: NonNullable<Curve['blend']>,
  origin: Vec3,
  element: Element,
): NonNullable<LineStyle['blend']> {
  const [x, y, z] = scale(axis, 1 / (toMm - fromMm || 1));
  const offset = dot([x, y, z], origin) - fromMm / (toMm - fromMm || 1);
  return { colour: resolveColour(colour, element), axis: [x, y, z, offset] };
}

const OUTLINE: LineStyle = { colour: [0.42, 0.22, 0.06], widthPx: 1.6 };

export function linesOf(
  stage: Stage,
  curves: readonly Curve[],
  plane: Plane | null,
  parts: readonly PartName[],
  mmPerPx: number,
  element: Element,
): Lines[] {
  const lines: Lines[] = curves.map((curve) => ({
    pieces: piecesOf(curve.positions, stage.origin, curve),
    ...(curve.values ? { values: pieceValues(curve.values, curve) } : {}),
    style: {
      colour: resolveColour(curve.colour, element),
      widthPx: curve.widthPx ?? 2,
      dashMm: curve.dashed ? 10 * mmPerPx : 0,
      ghost: curve.ghost ?? false,
      sectioned: true,
      ...(curve.blend ? { blend: blendOf(curve.blend, stage.origin, element) } : {}),
    },
  }));
  if (!plane) return lines;
  const offset = plane.offset - dot(plane.normal, stage.origin);
  const normal = plane.normal as [number, number, number];
  for (const part of parts) {
    const surfaces = [stage.meshOf(part), ...(part === 'relief' ? stage.plateSurfaces(part) : [])];
    for (const surface of surfaces) {
      if (!surface) continue;
      const pieces = cutOutline(surface.positions, surface.drawnIndices, normal, offset);
      lines.push({ pieces, part, style: OUTLINE });
    }
  }
  return lines;
}
