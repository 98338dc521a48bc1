// SPDX-License-Identifier: GPL-3.0-or-later
// Everything on the graphics card: the context, the parts on it (`stage_parts.ts`), how a picture of them is
// drawn (`picture_drawing.ts`) and read back. Knows no DOM beyond its canvas.
import * as THREE from 'three';
import type { Fixture, MeshData, Plate, Vec3, Viewpoint } from '../api';
import type { Colouring } from '../mesh/colouring';
import type { Support } from '../mesh/support';
import { GpuPace } from './gpu_pace';
import type { PartName } from './part';
import { Accumulation } from './passes';
import { type Lines, type Picture, PictureUniforms } from './picture';
import { PictureDrawing } from './picture_drawing';
import type { Quality } from './quality';
import { StageParts } from './stage_parts';
import type { Subject } from './subject';
import type { Surface } from './surface';
import type { Palette } from '../theme';

export class Stage {
  readonly renderer: THREE.WebGLRenderer;
  readonly pace: GpuPace;
  readonly canRefine: boolean;
  private readonly uniforms = new PictureUniforms();
  private readonly stageParts: StageParts;
  private readonly drawing: PictureDrawing;
  private readonly compiling = new Set<THREE.Material>();
  private pixelRatio = 1;

  constructor(
    canvas: HTMLCanvasElement | OffscreenCanvas,
    readonly quality: Quality,
  ) {
    const { antialias } = quality;
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
    this.canRefine = context.getExtension('EXT_color_buffer_float') !== null;
    this.stageParts = new StageParts(this.uniforms, quality, (objects) => this.compile(objects));
    this.drawing = new PictureDrawing(this.renderer, this.uniforms, this.stageParts, quality);
  }

  /** Has the driver make the shaders on its own threads; drawing before it is done would wait for them. */
  private compile(objects: THREE.Mesh<THREE.BufferGeometry, THREE.RawShaderMaterial>[]): void {
    const { scene, camera } = this.drawing;
    scene.children = objects;
    this.renderer.compile(scene, camera);
    scene.children = [];
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

  /** The scene's zero in model mm, for the parts set from now on. */
  get origin(): Vec3 {
    return this.uniforms.origin;
  }

  set origin(origin: Vec3) {
    this.uniforms.origin = origin;
  }

  get colouring(): Colouring {
    return this.stageParts.colouring;
  }

  setPalette(palette: Palette): void {
    this.drawing.setPalette(palette);
    this.colouring.setTokens(palette.maps);
  }

  setPart(
    name: PartName,
    mesh: MeshData | null,
    plate: Plate | null,
    viewpoint: Pick<Viewpoint, 'direction' | 'up'>,
    ground: Vec3 | null = null,
  ): void {
    this.stageParts.set(name, mesh, plate, viewpoint, ground);
  }

  /** `similar`: grown or moved, and otherwise the same. */
  updatePositions(name: PartName, positions: Float32Array | Float64Array, similar = false): void {
    this.stageParts.updatePositions(name, positions, similar);
  }

  /** For the parts set from now on. */
  setFixtures(fixtures: readonly Fixture[]): void {
    this.stageParts.setFixtures(fixtures);
  }

  moveFixture(id: string, positions: Float32Array | Float64Array, turned: boolean): void {
    this.stageParts.moveFixture(id, positions, turned);
  }

  setOpacity(name: PartName, opacity: number): void {
    this.stageParts.setOpacity(name, opacity);
  }

  meshOf(name: PartName): Surface | null {
    return this.stageParts.parts[name].mesh;
  }

  /** Outline of the mesh alone, without plate or ground. */
  meshSupport(name: PartName): Support {
    const part = this.stageParts.parts[name];
    return part.mesh?.support ?? part.subject.support;
  }

  plateSurfaces(name: PartName): readonly Surface[] {
    return this.stageParts.parts[name].extra;
  }

  subjectOf(name: PartName): Subject {
    return this.stageParts.parts[name].subject;
  }

  /** Whether the section leaves a point (from the scene's origin); null keeps everything. */
  cutTest(): ((p: Vec3) => boolean) | null {
    return this.uniforms.cutTest();
  }

  /** Takes away what lies beyond normal . p = offset (model mm); null keeps everything. */
  setSection(section: { normal: Vec3; offset: number } | null): void {
    this.uniforms.setSection(section);
  }

  setReach(value: number | null): void {
    this.uniforms.setReach(value);
  }

  setLines(lines: readonly Lines[]): void {
    this.drawing.setLines(lines, this.pixelRatio);
  }

  /** Bakes a little of the sky for the parts shown; true when a part was finished (draw again). */
  bake(names: readonly PartName[]): boolean {
    return this.stageParts.bake(this.renderer, names);
  }

  bakePendingFor(names: readonly PartName[]): boolean {
    return this.stageParts.bakePending(names);
  }

  resize(width: number, height: number, pixelRatio: number): void {
    this.pixelRatio = pixelRatio;
    this.renderer.setSize(width, height, false);
  }

  /** As `PictureDrawing.draw`; a single picture without a sample. */
  draw(
    picture: Picture,
    target: THREE.WebGLRenderTarget | null,
    width: number,
    height: number,
    sample = -1,
  ): void {
    this.drawing.draw(picture, target, width, height, sample);
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
    this.stageParts.forgetGpu();
  }

  dispose(): void {
    this.stageParts.dispose();
    this.drawing.dispose();
    this.renderer.dispose();
  }
}
