// SPDX-License-Identifier: GPL-3.0-or-later
// Everything on the graphics card: the subjects, their light, and how a picture of them is drawn, refined and
// read back. Knows no DOM beyond its canvas.
import * as THREE from 'three';
import type { Fixture, MeshData, Plate, Vec3, Viewpoint } from '../api';
import { type CameraState, type Screen, clipMatrix, viewCoordinates } from '../camera/camera';
import { SectionCaps } from '../overlay/caps';
import { Colouring } from '../mesh/colouring';
import { GpuPace } from './gpu_pace';
import { jitter } from './jitter';
import { LineSet, type LineStyle } from '../overlay/lines';
import {
  type MakeSurface,
  type Part,
  type PartName,
  PLASTER,
  addFixtures,
  addGround,
  addPlate,
} from './part';
import { Accumulation, ScreenPass } from './passes';
import type { Quality } from './quality';
import { backdropFragment } from './screen_shaders';
import { DepthView, SkyScratch, Subject, newBakeUniforms } from './subject';
import type { Support } from '../mesh/support';
import { Surface, type SurfaceOptions, type Uniforms } from './surface';
import type { Palette } from '../theme';
import { add, along, dot, perpendicular, rotate, scale, subtract } from '../vector';

export type { PartName } from './part';

export interface PicturePart {
  part: PartName;
  /** Columns of the canvas this part may draw in, 0..1. */
  from: number;
  to: number;
}

export interface Picture {
  camera: CameraState;
  screen: Screen;
  parts: readonly PicturePart[];
  /** Unit vectors in the model's axes. */
  towardsLight: Vec3;
  lightUp: Vec3;
  lightFront: Vec3;
  backdrop: boolean;
  /** Shadow of the plate on the bench. */
  plateShadow: boolean;
  ground: boolean;
}

/** Pieces of lines as `LineSet` takes them; without a part they are drawn with both. */
export interface Lines {
  readonly pieces: Float32Array;
  readonly style: LineStyle;
  readonly part?: PartName;
  readonly values?: Float32Array;
}

const KEY = 0.86;
const AMBIENT = 0.215;
/** Half angle of the key light as seen from the object, degrees: how soft its shadows are. */
const LIGHT_HALF_ANGLE = 2.6;
const OCCLUSION = 0.92;

export class Stage {
  readonly renderer: THREE.WebGLRenderer;
  readonly pace: GpuPace;
  origin: Vec3 = [0, 0, 0];
  readonly picture: Uniforms = {
    uSection: { value: new THREE.Vector4(0, 0, 0, 1) },
    uEye: { value: new THREE.Vector4(0, 0, 1, 0) },
    uUp: { value: new THREE.Vector3(0, 1, 0) },
    uFront: { value: new THREE.Vector3(0, 0, 1) },
    uLight: { value: new THREE.Vector3(0, 0, 1) },
    uInside: { value: new THREE.Vector3(-1, 0, 0) },
    uKey: { value: KEY },
    uAmbient: { value: AMBIENT },
    uNoise: { value: 0 },
    uViewport: { value: new THREE.Vector2(1, 1) },
    uReach: { value: 3e38 },
  };
  private readonly compiling = new Set<THREE.Material>();
  private readonly bakeUniforms = newBakeUniforms();
  private readonly parts: Record<PartName, Part>;
  private readonly camera = new THREE.Camera();
  private readonly scene = new THREE.Scene();
  private readonly depthView = new DepthView();
  private readonly sky: SkyScratch;
  private readonly backdrop = new ScreenPass(backdropFragment, {
    uCentre: { value: new THREE.Vector3() },
    uRim: { value: new THREE.Vector3() },
    uAspect: { value: new THREE.Vector2(1, 1) },
  });
  private fixtures: readonly Fixture[] = [];
  private lines: { set: LineSet; part: PartName | null }[] = [];
  private readonly caps: SectionCaps;
  readonly colouring: Colouring;
  private readonly canRefineHere: boolean;
  private palette: Palette | null = null;
  private sectionKey = '';
  private pixelRatio = 1;

  constructor(
    canvas: HTMLCanvasElement | OffscreenCanvas,
    readonly quality: Quality,
  ) {
    const { antialias } = quality;
    this.sky = new SkyScratch(quality.skySize);
    const context = canvas.getContext('webgl2', {
      antialias,
      alpha: false,
      stencil: true,
      depth: true,
      powerPreference: 'high-performance',
    }) as WebGL2RenderingContext | null;
    if (!context) throw new Error('webgl2');
    this.renderer = new THREE.WebGLRenderer({ canvas, context, antialias });
    this.renderer.autoClear = false;
    this.renderer.sortObjects = false;
    this.renderer.setPixelRatio(1);
    this.renderer.info.autoReset = false;
    // Asking for each shader's log waits for the compiler; ours are tested.
    this.renderer.debug.checkShaderErrors = false;
    this.pace = new GpuPace(context);
    this.canRefineHere = context.getExtension('EXT_color_buffer_float') !== null;
    this.camera.matrixWorldAutoUpdate = false;
    this.scene.matrixWorldAutoUpdate = false;
    this.caps = new SectionCaps(this.picture);
    const part = (): Part => ({
      subject: new Subject(this.bakeUniforms, quality),
      mesh: null,
      extra: [],
      fixtures: [],
      opacity: 1,
      plate: null,
      plateShadow: null,
    });
    this.parts = { original: part(), relief: part() };
    this.colouring = new Colouring(() =>
      (['original', 'relief'] as const).map((name) => [name, this.parts[name].mesh] as const),
    );
  }

  /** Has the driver make the shaders on its own threads; drawing before it is done would wait for them. */
  private compile(objects: THREE.Mesh<THREE.BufferGeometry, THREE.RawShaderMaterial>[]): void {
    this.scene.children = objects;
    this.renderer.compile(this.scene, this.camera);
    this.scene.children = [];
    for (const { material } of objects) this.compiling.add(material);
  }

  /** The card, or the shader compiler, still works on what it was given. */
  get busy(): boolean {
    for (const material of this.compiling) {
      const known = this.renderer.properties.get(material) as { currentProgram?: { isReady(): boolean } };
      if (known.currentProgram?.isReady() === false) return true;
      this.compiling.delete(material);
    }
    return this.pace.busy;
  }

  get canRefine(): boolean {
    return this.canRefineHere;
  }

  setPalette(palette: Palette): void {
    this.palette = palette;
    (this.backdrop.uniforms['uCentre']?.value as THREE.Vector3).set(...palette.viewCentre);
    (this.backdrop.uniforms['uRim']?.value as THREE.Vector3).set(...palette.viewRim);
    this.colouring.setTokens(palette.maps);
  }

  setPart(
    name: PartName,
    mesh: MeshData | null,
    plate: Plate | null,
    viewpoint: Pick<Viewpoint, 'direction' | 'up'>,
    ground: Vec3 | null = null,
  ): void {
    const part = this.parts[name];
    part.subject.dispose();
    part.subject = new Subject(this.bakeUniforms, this.quality);
    part.plateShadow?.dispose();
    part.plateShadow = null;
    part.plate = plate;
    part.extra = [];
    part.mesh = mesh ? this.surface(part, mesh, { albedo: PLASTER }) : null;
    const surface: MakeSurface = (extra, options) => this.surface(part, extra, options);
    if (plate) addPlate(part, plate, viewpoint, this.origin, surface);
    part.fixtures = [];
    const beside = this.fixtures.filter(({ parts }) => parts.includes(name));
    if (mesh) addFixtures(part, beside, viewpoint, this.origin, surface);
    if (part.mesh) part.mesh.setOpacity(part.opacity);
    if (ground && part.mesh) addGround(part, part.mesh, ground, this.origin, surface);
    part.subject.groundUp = ground;
    const standing = part.fixtures.map((fixture) => fixture.surface);
    part.subject.surfaces = [...(part.mesh ? [part.mesh] : []), ...part.extra, ...standing];
    part.subject.changed();
    this.colouring.apply();
    this.sectionKey += '!';
  }

  private surface(part: Part, mesh: MeshData, options: SurfaceOptions): Surface {
    const shared = { picture: this.picture, subject: part.subject.uniforms, bake: this.bakeUniforms };
    const made = new Surface(mesh, this.origin, shared, { ...options, shadowTaps: this.quality.shadowTaps });
    this.compile([made.main, made.depth]);
    return made;
  }

  /** `similar`: grown or moved, and otherwise the same. */
  updatePositions(name: PartName, positions: Float32Array | Float64Array, similar = false): void {
    const part = this.parts[name];
    part.mesh?.updatePositions(positions, similar);
    part.subject.changed();
    this.sectionKey += '!';
  }

  /** For the parts set from now on. */
  setFixtures(fixtures: readonly Fixture[]): void {
    this.fixtures = fixtures;
  }

  moveFixture(id: string, positions: Float32Array | Float64Array): void {
    this.fixtures = this.fixtures.map((old) =>
      old.id === id ? { ...old, mesh: { ...old.mesh, positions } } : old,
    );
    for (const part of Object.values(this.parts)) {
      const found = part.fixtures.find((fixture) => fixture.id === id);
      if (!found) continue;
      found.surface.updatePositions(positions, true);
      part.subject.changed();
    }
    this.sectionKey += '!';
  }

  setOpacity(name: PartName, opacity: number): void {
    const part = this.parts[name];
    const turned = part.opacity < 1 !== opacity < 1;
    part.opacity = opacity;
    part.mesh?.setOpacity(opacity);
    if (turned) part.subject.changed();
  }

  meshOf(name: PartName): Surface | null {
    return this.parts[name].mesh;
  }

  /** Outline of the mesh alone, without plate or ground. */
  meshSupport(name: PartName): Support {
    const part = this.parts[name];
    return part.mesh?.support ?? part.subject.support;
  }

  plateSurfaces(name: PartName): readonly Surface[] {
    return this.parts[name].extra;
  }

  subjectOf(name: PartName): Subject {
    return this.parts[name].subject;
  }

  plateOf(name: PartName): Plate | null {
    return this.parts[name].plate;
  }

  /** Tells what the section leaves (points from the scene's origin); null keeps everything. */
  cutTest(): ((p: Vec3) => boolean) | null {
    const { x, y, z, w } = this.picture['uSection']?.value as THREE.Vector4;
    return x === 0 && y === 0 && z === 0 ? null : (p) => x * p[0] + y * p[1] + z * p[2] <= w;
  }

  /** Takes away what lies beyond normal . p = offset (model mm); null keeps everything. */
  setSection(section: { normal: Vec3; offset: number } | null): void {
    const value = this.picture['uSection']?.value as THREE.Vector4;
    const inside = this.picture['uInside']?.value as THREE.Vector3;
    if (section) {
      value.set(...section.normal, section.offset - dot(section.normal, this.origin));
      inside.set(0.32, 0.25, 0.17);
    } else {
      value.set(0, 0, 0, 1);
      inside.set(-1, 0, 0);
    }
    this.sectionKey = value.toArray().join();
  }

  setReach(value: number | null): void {
    (this.picture['uReach'] as THREE.IUniform).value = value ?? 3e38;
  }

  setLines(lines: readonly Lines[]): void {
    for (const { set } of this.lines) set.dispose();
    this.lines = lines.map(({ pieces, style, part, values }) => ({
      set: new LineSet(pieces, style, this.picture, this.pixelRatio, values),
      part: part ?? null,
    }));
  }

  get bakePending(): boolean {
    return this.parts.original.subject.bakePending || this.parts.relief.subject.bakePending;
  }

  /** Bakes a little of the sky for the parts shown; true when a part was finished (draw again). */
  bake(names: readonly PartName[]): boolean {
    const waiting = names.map((n) => this.parts[n].subject).find((s) => s.bakePending);
    if (!waiting) return false;
    const done = waiting.bake(this.renderer, this.depthView, this.sky, this.quality.skyStep);
    this.renderer.setRenderTarget(null);
    return done;
  }

  bakePendingFor(names: readonly PartName[]): boolean {
    return names.some((n) => this.parts[n].subject.bakePending);
  }

  resize(width: number, height: number, pixelRatio: number): void {
    this.pixelRatio = pixelRatio;
    this.renderer.setSize(width, height, false);
  }

  /** Draws `picture` into the canvas or a target of `width` x `height` pixels. `sample` >= 0 is one of the
   *  jittered pictures of a refinement: its own place within the pixel and on the light. */
  draw(
    picture: Picture,
    target: THREE.WebGLRenderTarget | null,
    width: number,
    height: number,
    sample = -1,
  ): void {
    const { renderer } = this;
    const [jitterX, jitterY, discX, discY] = sample < 0 ? [0, 0, 0, 0] : jitter(sample);
    const angle = (LIGHT_HALF_ANGLE * Math.PI) / 180;
    const still = sample >= 0 && this.quality.softLight;
    const [lightX, lightY] = still ? [discX, discY] : [0, 0];
    const side = perpendicular(picture.towardsLight);
    const towards = rotate(
      rotate(picture.towardsLight, side, angle * lightX),
      rotate(side, picture.towardsLight, Math.PI / 2),
      angle * lightY,
    );
    for (const { part } of picture.parts) {
      const { subject, mesh } = this.parts[part];
      // A still picture samples the light itself; a moving one blurs the shadow's edge instead.
      const softness = (still ? 0.0015 : 0.011) * (mesh ? subject.support.radius : 1);
      subject.prepareShadow(renderer, this.depthView, towards, softness, this.sectionKey);
      subject.setOcclusionStrength(OCCLUSION);
    }
    this.setPictureUniforms(picture, towards, width, height, sample);
    renderer.setRenderTarget(target);
    this.setScissor(target, 0, width, height, width);
    renderer.setClearColor(0x000000, picture.backdrop ? 1 : 0);
    renderer.clear(true, true, true);
    for (const { part, from, to } of picture.parts) {
      const left = Math.round(from * width);
      const right = Math.round(to * width);
      if (right <= left) continue;
      this.setScissor(target, left, width, height, right);
      this.drawPart(picture, this.parts[part], part, width, height, [jitterX, jitterY]);
    }
    if (picture.parts.length === 0 && picture.backdrop) this.drawScene([this.backdrop.mesh]);
    this.setScissor(target, 0, width, height, width);
    renderer.setRenderTarget(null);
  }

  private drawPart(
    picture: Picture,
    part: Part,
    name: PartName,
    width: number,
    height: number,
    offset: readonly [number, number],
  ): void {
    this.setClip(picture, part.subject, width, height, offset);
    if (picture.backdrop) this.drawScene([this.backdrop.mesh]);
    const objects: THREE.Object3D[] = [];
    const cut = this.cutTest() !== null;
    for (const surface of part.subject.surfaces) {
      surface.setCut(cut);
      if (surface.main.material.transparent && !picture.ground) continue;
      if (surface.within && part.opacity === 1) continue;
      if (surface.opacity === 1) objects.push(surface.main);
    }
    if (
      part.plateShadow &&
      picture.plateShadow &&
      !this.cutTest() &&
      part.plateShadow.seenFrom(picture.camera)
    ) {
      part.plateShadow.aim(picture.towardsLight, this.palette?.dark ?? false);
      objects.push(part.plateShadow.mesh);
    }
    // What is seen through comes after what is behind it.
    for (const surface of part.subject.surfaces) if (surface.opacity < 1) objects.push(surface.main);
    this.drawScene(objects);
    const section = this.picture['uSection']?.value as THREE.Vector4;
    if (section.x !== 0 || section.y !== 0 || section.z !== 0) {
      this.renderer.clear(false, false, true);
      for (const step of this.caps.steps(part.subject, part.plate !== null)) this.drawScene(step);
    }
    const lines = this.lines.filter((l) => l.part === null || l.part === name).flatMap((l) => l.set.objects);
    if (lines.length > 0) this.drawScene(lines);
  }

  private drawScene(objects: THREE.Object3D[]): void {
    this.scene.children = objects;
    this.renderer.render(this.scene, this.camera);
    this.scene.children = [];
  }

  private setScissor(
    target: THREE.WebGLRenderTarget | null,
    left: number,
    width: number,
    height: number,
    right: number,
  ): void {
    if (target) {
      target.viewport.set(0, 0, width, height);
      target.scissor.set(left, 0, right - left, height);
      target.scissorTest = true;
      this.renderer.setRenderTarget(target);
    } else {
      this.renderer.setViewport(0, 0, width, height);
      this.renderer.setScissor(left, 0, right - left, height);
      this.renderer.setScissorTest(true);
    }
  }

  private setPictureUniforms(
    picture: Picture,
    towards: Vec3,
    width: number,
    height: number,
    sample: number,
  ): void {
    const { camera } = picture;
    const eye = this.picture['uEye']?.value as THREE.Vector4;
    if (camera.kappa > 0)
      eye.set(...subtract(along(camera.target, camera.forward, -1 / camera.kappa), this.origin), 1);
    else eye.set(...scale(camera.forward, -1), 0);
    (this.picture['uUp']?.value as THREE.Vector3).set(...picture.lightUp);
    (this.picture['uFront']?.value as THREE.Vector3).set(...picture.lightFront);
    (this.picture['uLight']?.value as THREE.Vector3).set(...towards);
    (this.picture['uNoise'] as THREE.IUniform).value = sample < 0 ? 0 : (sample * 0.61803399) % 1;
    (this.picture['uViewport']?.value as THREE.Vector2).set(width, height);
    (this.backdrop.uniforms['uAspect']?.value as THREE.Vector2).set(
      Math.max(1, width / height) ** 0.5,
      Math.max(1, height / width) ** 0.5,
    );
  }

  private setClip(
    picture: Picture,
    subject: Subject,
    width: number,
    height: number,
    offset: readonly [number, number],
  ): void {
    const { camera, screen } = picture;
    const { centre, radius } = subject.support;
    const c = viewCoordinates(camera, add(centre, this.origin))[2];
    // The ground reaches further than its object.
    const reach = (subject.groundUp ? 4 : 1.6) * radius;
    const m = clipMatrix(camera, screen, this.origin, c - reach, c + reach);
    // Jitter in pixels: x' = x + 2 jitter / width * w.
    for (let k = 0; k < 4; ++k) {
      const w = m[4 * k + 3] as number;
      m[4 * k] = (m[4 * k] as number) + ((2 * offset[0]) / width) * w;
      m[4 * k + 1] = (m[4 * k + 1] as number) + ((2 * offset[1]) / height) * w;
    }
    this.camera.projectionMatrix.fromArray(m);
  }

  /** A finished picture, r, g, b, a bytes, rows from the top. */
  async read(
    picture: Picture,
    width: number,
    height: number,
    samples: number,
  ): Promise<Uint8ClampedArray<ArrayBuffer>> {
    const accumulation = new Accumulation(width, height);
    try {
      const count = this.canRefine ? samples : 1;
      for (let i = 0; i < count; ++i) {
        await this.pace.done();
        this.draw(picture, accumulation.frame, width, height, count > 1 ? i : -1);
        accumulation.add(this.renderer, i);
        this.pace.mark();
      }
      await this.pace.done();
      return await accumulation.read(this.renderer);
    } finally {
      accumulation.dispose();
      this.renderer.setRenderTarget(null);
    }
  }

  /** The context was lost: everything on the card must be made again. */
  forgetGpu(): void {
    this.pace.forget();
    this.parts.original.subject.forgetGpu();
    this.parts.relief.subject.forgetGpu();
    this.sky.dispose();
  }

  dispose(): void {
    for (const part of Object.values(this.parts)) {
      part.subject.dispose();
      part.plateShadow?.dispose();
    }
    for (const { set } of this.lines) set.dispose();
    this.colouring.dispose();
    this.sky.dispose();
    this.caps.dispose();
    this.backdrop.dispose();
    this.renderer.dispose();
  }
}
