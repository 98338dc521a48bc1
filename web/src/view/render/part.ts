// SPDX-License-Identifier: GPL-3.0-or-later
// What belongs to the original or to the relief, and what is put beside the mesh itself.
import type { Fixture, MeshData, Plate, Vec3, Viewpoint } from '../api';
import { groundSquare, plateBody, plateFrame, plateFront } from '../overlay/plate';
import { PlateShadow } from '../overlay/plate_shadow';
import { groundFragment } from './screen_shaders';
import type { Subject } from './subject';
import type { Surface, SurfaceOptions } from './surface';
import { dot } from '../vector';

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

/** A square below the object that receives its shadow. */
export function addGround(part: Part, mesh: Surface, up: Vec3, origin: Vec3, surface: MakeSurface): void {
  const { points, centre, radius } = mesh.support;
  let lowest = Infinity;
  for (let i = 0; i < points.length; i += 3) {
    lowest = Math.min(
      lowest,
      dot(up, [points[i] as number, points[i + 1] as number, points[i + 2] as number]),
    );
  }
  const square = groundSquare(centre as Vec3, radius, lowest - 1e-3 * radius, up, 2.4);
  const positions = Float64Array.from(square.positions, (x, i) => x + (origin[i % 3] as number));
  const ground = surface(
    { ...square, positions },
    {
      albedo: PLATE,
      picture: { width: 384, height: 384 },
      blur: 0.16,
      fragment: groundFragment,
      transparent: true,
    },
  );
  ground.main.material.uniforms['uStrength'] = { value: 0.8 };
  part.extra.push(ground);
}
