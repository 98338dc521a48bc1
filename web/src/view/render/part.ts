// SPDX-License-Identifier: GPL-3.0-or-later
// What belongs to the original or to the relief, and what is put beside the mesh itself.
import type { Fixture, MeshData, Plate, Vec3, Viewpoint } from '../api';
import type { GroundShadow } from '../overlay/ground_shadow';
import { plateBody, plateFrame, plateFront } from '../overlay/plate';
import { PlateShadow } from '../overlay/plate_shadow';
import type { Subject } from './subject';
import type { Surface, SurfaceOptions } from './surface';

export type PartName = 'original' | 'relief';

/** Linear reflectances: warm plaster, its plate a little darker, as an object stands out from its ground. */
export const PLASTER: Vec3 = [0.93, 0.845, 0.715];
const PLATE: Vec3 = [0.84, 0.755, 0.628];

export interface Part {
  subject: Subject;
  mesh: Surface | null;
  extra: Surface[];
  fixtures: { id: string; surface: Surface }[];
  opacity: number;
  plate: Plate | null;
  plateShadow: PlateShadow | null;
  groundShadow: GroundShadow | null;
}

export type MakeSurface = (mesh: MeshData, options: SurfaceOptions) => Surface;

/** The plate's slab or own mesh, and its shadow. */
export function addPlate(
  part: Part,
  plate: Plate,
  viewpoint: Pick<Viewpoint, 'direction' | 'up'>,
  origin: Vec3,
  surface: MakeSurface,
): void {
  const frame = plateFrame(plate, viewpoint);
  if (plate.mesh) {
    part.extra.push(surface(plate.mesh, { albedo: PLATE }));
  } else if (plate.mesh !== false) {
    const width = 640;
    const height = Math.min(1024, Math.max(64, Math.round((width * plate.heightMm) / plate.widthMm)));
    part.extra.push(surface(plateFront(frame), { albedo: PLATE, picture: { width, height } }));
    const body = plateBody(frame);
    if (body) part.extra.push(surface(body, { albedo: PLATE }));
  }
  part.plateShadow = new PlateShadow(frame, origin);
}

/** What stands beside the mesh; nothing without one. */
export function addFixtures(
  part: Part,
  fixtures: readonly Fixture[],
  viewpoint: Pick<Viewpoint, 'direction' | 'up'>,
  origin: Vec3,
  surface: MakeSurface,
): void {
  part.fixtures = fixtures.map(({ id, mesh, within, framed, shadow }) => {
    const made = surface(mesh, { albedo: PLASTER });
    made.within = within ?? false;
    made.framed = framed ?? true;
    if (shadow) part.plateShadow ??= new PlateShadow(plateFrame(shadow, viewpoint), origin);
    return { id, surface: made };
  });
}
