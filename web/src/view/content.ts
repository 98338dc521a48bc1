// SPDX-License-Identifier: GPL-3.0-or-later
// What a viewport shows: meshes, plate, mode, colours, section, curves; kept here and put on the stage.
import type { ColourMapping, Curve, Fixture, MeshData, Plate, Section, Vec3, ViewMode } from './api';
import { type Bounds2, type CameraState, projectedBounds, uniteBounds } from './camera/camera';
import type { CameraRig } from './camera/camera_rig';
import type { Picker } from './pick/picker';
import { boxOf, sameIndices, samePlate } from './same';
import { linesOf, sectionPlane } from './overlay/section_lines';
import type { PartName } from './render/part';
import type { Stage } from './render/stage';
import { add, length, normalise, scale, subtract } from './vector';

export class Content {
  meshes: Record<PartName, MeshData | null> = { original: null, relief: null };
  plate: Plate | null = null;
  mapping: ColourMapping | null = null;
  private mappingAlways = false;
  private section: Section | null = null;
  private curves: readonly Curve[] = [];

  constructor(
    private readonly stage: Stage,
    private readonly picker: Picker,
    private readonly rig: () => CameraRig,
    public mode: ViewMode,
    public ground: boolean,
    /** For colours by the names of tokens. */
    private readonly element: Element,
  ) {}

  /** True when this is the first mesh there is. */
  setOriginal(mesh: MeshData | null): boolean {
    const first = this.isEmpty();
    this.meshes.original = mesh;
    if (mesh) this.chooseOrigin(mesh);
    this.upload('original');
    this.refresh();
    return first && mesh !== null;
  }

  setRelief(mesh: MeshData | null, plate: Plate | null): boolean {
    const before = this.meshes.relief;
    const first = this.isEmpty();
    const kept = samePlate(plate, this.plate) && sameTopology(before, mesh);
    this.meshes.relief = mesh;
    this.plate = plate;
    if (mesh && first) this.chooseOrigin(mesh);
    if (kept && mesh) {
      // The same triangles, moved: keep buffers, light and tree.
      this.stage.updatePositions('relief', mesh.positions);
      this.stage.colouring.forgetAttributes('relief');
      for (const [name, values] of Object.entries(mesh.attributes ?? {})) {
        this.stage.colouring.setAttribute('relief', name, values);
      }
    } else this.upload('relief');
    this.refresh();
    return first && mesh !== null;
  }

  update(
    part: PartName,
    positions: Float32Array | Float64Array,
    plate?: Plate | null,
    similar = false,
  ): void {
    const mesh = this.meshes[part];
    if (!mesh) return;
    if (positions.length !== mesh.positions.length) {
      throw new RangeError(
        `The ${part} has ${mesh.positions.length / 3} vertices; positions for ${positions.length / 3} were given.`,
      );
    }
    if (plate !== undefined && !samePlate(plate, this.plate)) {
      this.setRelief({ ...mesh, positions }, plate);
      return;
    }
    if (plate) this.plate = plate;
    this.meshes[part] = { ...mesh, positions };
    this.stage.updatePositions(part, positions, similar);
    this.refresh();
  }

  updateColours(part: PartName, colours: Float32Array): void {
    const mesh = this.meshes[part];
    if (!mesh?.colours) throw new RangeError(`The ${part} was given without colours.`);
    this.meshes[part] = { ...mesh, colours };
    this.stage.meshOf(part)?.updateColours(colours);
  }

  setFixtures(fixtures: readonly Fixture[]): void {
    this.stage.setFixtures(fixtures);
    this.upload('original');
    this.upload('relief');
    this.refresh();
  }

  /** Plate and ground stand by the viewpoint's axes. */
  viewpointTurned(): void {
    if (this.plate && !this.plate.direction) this.upload('relief');
    if (this.ground && this.meshes.original) this.upload('original');
    this.refresh();
  }

  setMode(mode: ViewMode): void {
    this.mode = mode;
    this.refresh();
  }

  setGround(visible: boolean): void {
    if (visible === this.ground) return;
    this.ground = visible;
    this.upload('original');
    this.refresh();
  }

  setMapping(mapping: ColourMapping | null, always: boolean): void {
    this.mapping = mapping;
    this.mappingAlways = always;
    this.applyMapping();
  }

  setRange(minimum: number, maximum: number): void {
    if (this.mapping) this.setMapping({ ...this.mapping, minimum, maximum }, this.mappingAlways);
  }

  setSection(section: Section | null): void {
    this.section = section;
    this.applyLines();
  }

  setCurves(curves: readonly Curve[]): void {
    this.curves = curves;
    this.applyLines();
  }

  /** Whether values are shown as colours now. */
  get mapped(): boolean {
    return this.mapping !== null && (this.mode === 'error' || this.mappingAlways);
  }

  /** After the mode, the theme or a shape changed. */
  refresh(): void {
    this.applyMapping();
    this.applyLines();
  }

  private applyMapping(): void {
    const parts = this.mappingAlways ? ['original', 'relief'] : ['relief'];
    this.stage.colouring.setMapping(this.mapped ? this.mapping : null, parts);
  }

  private applyLines(): void {
    const { section, stage } = this;
    const plane = section ? sectionPlane(section, this.rig().viewpoint) : null;
    stage.setSection(plane);
    stage.setLines(linesOf(stage, this.curves, plane, this.parts(), this.rig().mmPerPx, this.element));
  }

  private isEmpty(): boolean {
    return this.meshes.original === null && this.meshes.relief === null;
  }

  private upload(part: PartName): void {
    const { stage } = this;
    for (const surface of [stage.meshOf(part), ...stage.plateSurfaces(part)]) {
      if (surface) this.picker.forget(surface);
    }
    stage.colouring.forgetAttributes(part);
    const { viewpoint } = this.rig();
    const ground = this.ground && part === 'original' ? normalise(viewpoint.up) : null;
    stage.setPart(part, this.meshes[part], part === 'relief' ? this.plate : null, viewpoint, ground);
  }

  /** Single precision is fine near its zero: put it into the middle of the model. The caller uploads `mesh`. */
  private chooseOrigin(mesh: MeshData): void {
    const box = boxOf(mesh.positions);
    if (!box) return;
    const centre = scale(add(box.low, box.high), 0.5);
    const size = length(subtract(box.high, box.low));
    if (length(subtract(centre, this.stage.origin)) < 0.25 * size) return;
    this.stage.origin = centre;
    for (const part of ['original', 'relief'] as const) {
      if (this.meshes[part] && this.meshes[part] !== mesh) this.upload(part);
    }
  }

  /** What the mode shows of what there is. */
  parts(): PartName[] {
    const wanted: PartName[] =
      this.mode === 'swipe' ? ['original', 'relief'] : this.mode === 'original' ? ['original'] : ['relief'];
    const there = wanted.filter((name) => this.meshes[name]);
    if (there.length > 0) return there;
    return (['relief', 'original'] as const).filter((name) => this.meshes[name]).slice(0, 1);
  }

  /** Of everything there is, or of what the mode shows. */
  bounds(camera: CameraState, only: 'all' | 'shown'): Bounds2 | null {
    const names = only === 'all' ? (['original', 'relief'] as const) : this.parts();
    let bounds: Bounds2 | null = null;
    for (const name of names) {
      if (!this.meshes[name]) continue;
      const { points } = this.stage.subjectOf(name).framing;
      bounds = uniteBounds(bounds, projectedBounds(camera, points, this.stage.origin));
    }
    return bounds;
  }

  centre(): Vec3 | null {
    const name = this.parts()[0];
    return name ? add(this.stage.meshSupport(name).centre, this.stage.origin) : null;
  }

  radius(): number | null {
    const name = this.parts()[0];
    return name ? this.stage.meshSupport(name).radius : null;
  }

  triangleCount(): number {
    return this.parts().reduce((n, name) => n + this.stage.subjectOf(name).triangleCount, 0);
  }
}

function sameTopology(a: MeshData | null, b: MeshData | null): boolean {
  if (!a || !b || a.positions.length !== b.positions.length) return false;
  if (a.normals || b.normals || !sameIndices(a.indices, b.indices)) return false;
  return a.uvs === b.uvs && a.cornerUvs === b.cornerUvs && a.colours === b.colours && a.texture === b.texture;
}
