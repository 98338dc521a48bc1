// SPDX-License-Identifier: GPL-3.0-or-later
// The original and the relief on the graphics card: their meshes, what stands beside them, their colours
// and their sky.
import type * as THREE from 'three';
import type { Fixture, MeshData, Plate, Vec3, Viewpoint } from '../api';
import { Colouring } from '../mesh/colouring';
import { type MakeSurface, type Part, type PartName, PLASTER, addFixtures, addPlate } from './part';
import { GroundShadow } from '../overlay/ground_shadow';
import type { PictureUniforms } from './picture';
import type { Quality } from './quality';
import { DepthView, SkyScratch, Subject, newBakeUniforms } from './subject';
import { Surface, type SurfaceOptions } from './surface';

type Drawn = THREE.Mesh<THREE.BufferGeometry, THREE.RawShaderMaterial>;

export class StageParts {
  readonly parts: Record<PartName, Part>;
  readonly colouring: Colouring;
  readonly depthView = new DepthView();
  private readonly bakeUniforms = newBakeUniforms();
  private readonly sky: SkyScratch;
  private fixtures: readonly Fixture[] = [];

  constructor(
    private readonly picture: PictureUniforms,
    private readonly quality: Quality,
    /** Has the driver make the shaders of new surfaces. */
    private readonly compile: (objects: Drawn[]) => void,
  ) {
    this.sky = new SkyScratch(quality.skySize);
    const part = (): Part => ({
      subject: new Subject(this.bakeUniforms, quality),
      mesh: null,
      extra: [],
      fixtures: [],
      opacity: 1,
      plate: null,
      plateShadow: null,
      groundShadow: null,
    });
    this.parts = { original: part(), relief: part() };
    this.colouring = new Colouring(() =>
      (['original', 'relief'] as const).map((name) => [name, this.parts[name].mesh] as const),
    );
  }

  set(
    name: PartName,
    mesh: MeshData | null,
    plate: Plate | null,
    viewpoint: Pick<Viewpoint, 'direction' | 'up'>,
    ground: Vec3 | null,
  ): void {
    const part = this.parts[name];
    const { origin } = this.picture;
    part.subject.dispose();
    part.subject = new Subject(this.bakeUniforms, this.quality);
    part.plateShadow?.dispose();
    part.groundShadow?.dispose();
    part.plateShadow = part.groundShadow = null;
    part.plate = plate;
    part.extra = [];
    part.mesh = mesh ? this.surface(part, mesh, { albedo: PLASTER }) : null;
    const surface: MakeSurface = (extra, options) => this.surface(part, extra, options);
    if (plate) addPlate(part, plate, viewpoint, origin, surface);
    part.fixtures = [];
    const beside = this.fixtures.filter(({ parts }) => parts.includes(name));
    if (mesh) addFixtures(part, beside, viewpoint, origin, surface);
    if (part.mesh) part.mesh.setOpacity(part.opacity);
    if (ground && part.mesh)
      part.groundShadow = new GroundShadow(part.mesh.support, ground, origin, this.quality.groundSize);
    part.subject.ground = part.groundShadow;
    const standing = part.fixtures.map((fixture) => fixture.surface);
    part.subject.surfaces = [...(part.mesh ? [part.mesh] : []), ...part.extra, ...standing];
    part.subject.changed();
    this.colouring.apply();
    this.picture.shapeChanged();
  }

  private surface(part: Part, mesh: MeshData, options: SurfaceOptions): Surface {
    const { picture, bakeUniforms, quality } = this;
    const shared = { picture: picture.values, subject: part.subject.uniforms, bake: bakeUniforms };
    const made = new Surface(mesh, picture.origin, shared, { ...options, shadowTaps: quality.shadowTaps });
    this.compile([made.main, made.depth]);
    return made;
  }

  /** `similar`: grown or moved, and otherwise the same. */
  updatePositions(name: PartName, positions: Float32Array | Float64Array, similar: boolean): void {
    const part = this.parts[name];
    part.mesh?.updatePositions(positions, similar);
    part.subject.changed();
    this.picture.shapeChanged();
  }

  /** For the parts set from now on. */
  setFixtures(fixtures: readonly Fixture[]): void {
    this.fixtures = fixtures;
  }

  moveFixture(id: string, positions: Float32Array | Float64Array, turned: boolean): void {
    this.fixtures = this.fixtures.map((old) =>
      old.id === id ? { ...old, mesh: { ...old.mesh, positions } } : old,
    );
    for (const part of Object.values(this.parts)) {
      const found = part.fixtures.find((fixture) => fixture.id === id);
      if (!found) continue;
      found.surface.updatePositions(positions, !turned);
      part.subject.changed();
    }
    this.picture.shapeChanged();
  }

  setOpacity(name: PartName, opacity: number): void {
    const part = this.parts[name];
    const turned = part.opacity < 1 !== opacity < 1;
    part.opacity = opacity;
    part.mesh?.setOpacity(opacity);
    if (turned) part.subject.changed();
  }

  /** Bakes a little of the sky for the parts named; true when a part was finished (draw again). */
  bake(renderer: THREE.WebGLRenderer, names: readonly PartName[]): boolean {
    const waiting = names.map((name) => this.parts[name].subject).find((subject) => subject.bakePending);
    if (!waiting) return false;
    const done = waiting.bake(renderer, this.depthView, this.sky, this.quality.skyStep);
    renderer.setRenderTarget(null);
    return done;
  }

  bakePending(names: readonly PartName[]): boolean {
    return names.some((name) => this.parts[name].subject.bakePending);
  }

  forgetGpu(): void {
    this.parts.original.subject.forgetGpu();
    this.parts.relief.subject.forgetGpu();
    this.sky.dispose();
  }

  dispose(): void {
    for (const part of Object.values(this.parts)) {
      part.subject.dispose();
      part.plateShadow?.dispose();
      part.groundShadow?.dispose();
    }
    this.colouring.dispose();
    this.sky.dispose();
  }
}
