// SPDX-License-Identifier: GPL-3.0-or-later
// The viewport: state, camera and the calls of `api.ts`. Drawing is `stage.ts`, furniture `furniture.ts`.
import './view.css';
import type {
  ColourMapping,
  Curve,
  Hit,
  Insets,
  LightDirection,
  Marker,
  MeshData,
  Plate,
  Projection,
  Section,
  Theme,
  Vec3,
  ViewMode,
  Viewpoint,
  ViewportApi,
  ViewportOptions,
  ViewStatus,
} from './api';
import {
  type Bounds2,
  type CameraState,
  type Screen,
  blended,
  cameraFromViewpoint,
  fitWindow,
  makeScreen,
  mmPerPixel,
  orbited,
  panned,
  projectToPixels,
  projectedBounds,
  rayThroughPixel,
  remeasured,
  sameEye,
  uniteBounds,
  viewpointFromCamera,
  zoomed,
} from './camera';
import { type ControlTarget, Controls } from './controls';
import { FrameLoop } from './frame_loop';
import { Furniture } from './furniture';
import { DEFAULT_LIGHT, towardsLight } from './light';
import { piecesOf } from './lines';
import { Accumulation } from './passes';
import { Picker } from './picker';
import { plateCorners, plateFrame } from './plate';
import { cutOutline } from './section';
import { type PartName, type Picture, type PicturePart, Stage } from './stage';
import { type Palette, prefersReducedMotion, readPalette, resolveColour } from './theme';
import { add, dot, normalise, scale, subtract, viewerAxes } from './vector';
import { encodePng } from './png';

const DEFAULT_VIEWPOINT: Viewpoint = {
  projection: 'orthographic',
  direction: [0, 0, -1],
  up: [0, 1, 0],
  targetMm: [0, 0, 0],
  distanceMm: 500,
  fieldOfViewDeg: 20,
};
const UNSUPPORTED =
  'This browser cannot draw in 3D: it offers no WebGL 2. Update the browser, or allow hardware acceleration in its settings.';
const LOST =
  'The graphics card let go of the picture. It comes back by itself; if it does not, reload the page.';

/** Coasting fades with this time, ms. */
const COAST_MS = 80;
const MOVE_MS = 360;
const FIT_MARGIN_PX = 16;
const DIMENSION_PX = 30;

export class Viewport implements ViewportApi {
  readonly canvas = document.createElement('canvas');
  readonly overlay: HTMLDivElement;
  private readonly root = document.createElement('div');
  private readonly furniture: Furniture;
  private readonly controls: Controls;
  private readonly picker: Picker;
  private readonly loop: FrameLoop;
  private readonly resizing: ResizeObserver;
  private readonly themeWatch: MutationObserver;
  private stage: Stage | null = null;
  private accumulation: Accumulation | null = null;
  private statusNow: ViewStatus = { state: 'ready' };

  private meshes: Record<PartName, MeshData | null> = { original: null, relief: null };
  private plate: Plate | null = null;
  private mode: ViewMode;
  private swipe = 0.5;
  private light: LightDirection;
  private mapping: ColourMapping | null = null;
  private mappingAlways = false;
  private section: Section | null = null;
  private curves: readonly Curve[] = [];
  private theme: Theme;
  private palette: Palette;
  private insets: Insets;
  private showDimensions: boolean;
  private showGround: boolean;

  private viewpoint: Viewpoint = DEFAULT_VIEWPOINT;
  private viewpointGiven = false;
  private camera: CameraState = cameraFromViewpoint(DEFAULT_VIEWPOINT, 60);
  private screen: Screen = makeScreen(1, 1, { left: 0, top: 0, right: 0, bottom: 0 });
  private pixelRatio = 1;
  /** The window was fitted and nobody touched it: keep fitting when shapes or the screen change. */
  private fitted = true;
  private turntable: Vec3 = [0, 1, 0];
  private pivot: Vec3 | null = null;
  private moving: { from: CameraState; to: CameraState; since: number | null } | null = null;
  private coasting: [number, number] | null = null;
  private pointer: { event: PointerEvent; xPx: number; yPx: number } | null = null;
  private hoverPending = false;

  constructor(
    private readonly container: HTMLElement,
    private readonly options: ViewportOptions = {},
  ) {
    this.mode = options.mode ?? 'original';
    this.light = options.light ?? DEFAULT_LIGHT;
    this.theme = options.theme ?? 'auto';
    this.insets = options.freeRectangle ?? { left: 0, top: 0, right: 0, bottom: 0 };
    this.showDimensions = options.dimensions ?? true;
    this.showGround = options.ground ?? false;
    this.root.className = 'fw-view';
    this.root.tabIndex = 0;
    this.root.setAttribute('role', 'application');
    this.root.setAttribute('aria-roledescription', '3D view');
    this.root.setAttribute('aria-label', options.label ?? 'Viewport');
    this.root.setAttribute('aria-keyshortcuts', 'ArrowLeft ArrowRight ArrowUp ArrowDown + - 0 F');
    this.canvas.setAttribute('aria-hidden', 'true');
    this.furniture = new Furniture(this.root, (position) => {
      this.setSwipe(position);
      this.options.onSwipe?.(position);
    });
    this.overlay = this.furniture.element;
    this.root.append(this.canvas, this.overlay);
    container.append(this.root);
    this.palette = readPalette(this.theme, this.root);
    this.picker = new Picker(() => this.hoverLater());
    this.loop = new FrameLoop({
      animate: (now, elapsed) => this.animate(now, elapsed),
      draw: () => this.draw(),
      bakePending: () => this.stage?.bakePendingFor(this.partNames()) ?? false,
      bake: () => this.stage?.bake(this.stage.software ? 4 : 20, this.partNames()) ?? false,
      refineSamples: () => this.refineSamples(),
      refine: (sample) => this.refine(sample),
      triangles: () => this.triangleCount(),
      onFrame: (stats) => this.options.onFrame?.(stats),
    });
    this.controls = new Controls(this.root, this.canvas, this.controlTarget());
    this.canvas.addEventListener('webglcontextlost', this.contextLost);
    this.canvas.addEventListener('webglcontextrestored', this.contextRestored);
    this.resizing = new ResizeObserver(() => this.resized());
    this.resizing.observe(container);
    this.themeWatch = new MutationObserver(() => this.themeChanged());
    this.themeWatch.observe(document.documentElement, {
      attributes: true,
      attributeFilter: ['data-theme', 'class', 'style'],
    });
    try {
      this.stage = new Stage(this.canvas, true);
      this.stage.setPalette(this.palette);
    } catch {
      this.setStatus({ state: 'unsupported', message: UNSUPPORTED });
    }
    this.resized();
  }

  get status(): ViewStatus {
    return this.statusNow;
  }

  // Meshes

  setOriginal(mesh: MeshData | null): void {
    const first = this.meshes.original === null && this.meshes.relief === null;
    this.meshes.original = mesh;
    if (mesh) this.chooseOrigin(mesh);
    this.upload('original');
    this.shapeChanged(first && mesh !== null);
  }

  setRelief(mesh: MeshData | null, plate: Plate | null): void {
    const first = this.meshes.original === null && this.meshes.relief === null;
    this.meshes.relief = mesh;
    this.plate = plate;
    if (mesh && first) this.chooseOrigin(mesh);
    this.upload('relief');
    this.shapeChanged(first && mesh !== null);
  }

  updateOriginal(positions: Float32Array | Float64Array): void {
    this.update('original', positions);
  }

  updateRelief(positions: Float32Array | Float64Array, plate?: Plate | null): void {
    if (plate !== undefined && !samePlate(plate, this.plate)) {
      const mesh = this.meshes.relief;
      if (mesh) this.setRelief({ ...mesh, positions }, plate);
      return;
    }
    if (plate) this.plate = plate;
    this.update('relief', positions);
  }

  updateAttribute(part: PartName, name: string, values: Float32Array): void {
    this.stage?.setAttribute(part, name, values);
    this.invalidate();
  }

  private update(part: PartName, positions: Float32Array | Float64Array): void {
    const mesh = this.meshes[part];
    if (!mesh) return;
    if (positions.length !== mesh.positions.length) {
      throw new RangeError(
        `The ${part} has ${mesh.positions.length / 3} vertices; positions for ${positions.length / 3} were given.`,
      );
    }
    this.meshes[part] = { ...mesh, positions };
    this.stage?.updatePositions(part, positions);
    this.shapeChanged(false);
  }

  private upload(part: PartName): void {
    if (!this.stage) return;
    const before = this.stage.meshOf(part);
    if (before) this.picker.forget(before);
    for (const surface of this.stage.plateSurfaces(part)) this.picker.forget(surface);
    this.stage.setAttribute(part, '', null);
    const ground = this.showGround && part === 'original' ? normalise(this.viewpoint.up) : null;
    this.stage.setPart(
      part,
      this.meshes[part],
      part === 'relief' ? this.plate : null,
      this.viewpoint,
      ground,
    );
  }

  /** Single precision is fine near its zero: put it into the middle of the model. */
  private chooseOrigin(mesh: MeshData): void {
    if (!this.stage || mesh.positions.length === 0) return;
    const low: [number, number, number] = [Infinity, Infinity, Infinity];
    const high: [number, number, number] = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < mesh.positions.length; ++i) {
      const k = (i % 3) as 0 | 1 | 2;
      const x = mesh.positions[i] as number;
      if (x < low[k]) low[k] = x;
      if (x > high[k]) high[k] = x;
    }
    const centre = scale(add(low, high), 0.5);
    const size = Math.hypot(...subtract(high, low));
    if (!Number.isFinite(size) || Math.hypot(...subtract(centre, this.stage.origin)) < 0.25 * size) return;
    this.stage.origin = centre;
    for (const part of ['original', 'relief'] as const) if (this.meshes[part]) this.upload(part);
  }

  private shapeChanged(first: boolean): void {
    this.applyMapping();
    this.applySection();
    if (first && !this.viewpointGiven) this.viewpoint = { ...this.viewpoint, targetMm: this.centre() };
    if (first) this.lookFromViewpoint(false);
    else if (this.fitted) this.refit();
    this.invalidate();
  }

  // What is shown

  setMode(mode: ViewMode): void {
    if (mode === this.mode) return;
    this.mode = mode;
    this.applyMapping();
    this.applySection();
    if (this.fitted) this.refit();
    this.invalidate();
  }

  setSwipe(position: number): void {
    this.swipe = Math.min(1, Math.max(0, position));
    this.invalidate();
  }

  setLight(light: LightDirection): void {
    this.light = light;
    this.invalidate();
  }

  setColourMapping(mapping: ColourMapping | null, always = false): void {
    this.mapping = mapping;
    this.mappingAlways = always;
    this.applyMapping();
    this.invalidate();
  }

  setErrorRange(minimum: number, maximum: number): void {
    if (this.mapping) this.setColourMapping({ ...this.mapping, minimum, maximum }, this.mappingAlways);
  }

  private applyMapping(): void {
    const shown = this.mapping && (this.mode === 'error' || this.mappingAlways);
    this.stage?.setMapping(
      shown ? this.mapping : null,
      this.mappingAlways ? ['original', 'relief'] : ['relief'],
    );
    this.furniture.clearValue();
  }

  setSection(section: Section | null): void {
    this.section = section;
    this.applySection();
    this.invalidate();
  }

  private applySection(): void {
    const { stage, section } = this;
    if (!stage) return;
    let normal: Vec3 | null = null;
    if (section) {
      const axes = {
        x: [1, 0, 0],
        y: [0, 1, 0],
        z: [0, 0, 1],
        view: viewerAxes(this.viewpoint.direction, this.viewpoint.up).right,
      } as const;
      normal = normalise(typeof section.axis === 'string' ? axes[section.axis] : section.axis, [1, 0, 0]);
    }
    const sign = section?.flipped ? -1 : 1;
    stage.setSection(
      section && normal ? { normal: scale(normal, sign), offset: sign * section.positionMm } : null,
    );
    const lines: Parameters<Stage['setLines']>[0][number][] = this.curves.map((curve) => ({
      pieces: piecesOf(curve.positions, stage.origin, curve.closed ?? false),
      style: {
        colour: resolveColour(curve.colour, this.root),
        widthPx: curve.widthPx ?? 2,
        dashMm: curve.dashed ? 6 * mmPerPixel(this.camera, this.screen) : 0,
        ghost: curve.ghost ?? false,
        sectioned: true,
      },
    }));
    if (section && normal) {
      for (const part of this.partNames()) {
        for (const surface of [stage.meshOf(part), ...(part === 'relief' ? stage.plateSurfaces(part) : [])]) {
          if (!surface) continue;
          const offset = section.positionMm - dot(normal, stage.origin);
          const pieces = cutOutline(
            surface.positions,
            surface.drawnIndices,
            normal as [number, number, number],
            offset,
          );
          lines.push({ pieces, part, style: { colour: [0.42, 0.22, 0.06], widthPx: 1.6 } });
        }
      }
    }
    stage.setLines(lines, this.pixelRatio);
  }

  setCurves(curves: readonly Curve[]): void {
    this.curves = curves;
    this.applySection();
    this.invalidate();
  }

  setMarkers(markers: readonly Marker[]): void {
    this.furniture.setMarkers(markers);
    this.layOut();
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    this.themeChanged();
  }

  private themeChanged(): void {
    this.palette = readPalette(this.theme, this.root);
    this.stage?.setPalette(this.palette);
    this.applySection();
    this.invalidate();
  }

  setFreeRectangle(insets: Insets): void {
    this.insets = insets;
    this.resized();
  }

  setDimensionsVisible(visible: boolean): void {
    this.showDimensions = visible;
    if (this.fitted) this.refit();
    this.invalidate();
  }

  setGround(visible: boolean): void {
    if (visible === this.showGround) return;
    this.showGround = visible;
    this.upload('original');
    this.shapeChanged(false);
  }

  // Camera

  setViewpoint(viewpoint: Viewpoint): void {
    const distanceMm =
      viewpoint.distanceMm > 0
        ? viewpoint.distanceMm
        : this.radius() / Math.tan((Math.min(120, Math.max(0.1, viewpoint.fieldOfViewDeg)) * Math.PI) / 360);
    const turned =
      this.plate &&
      !this.plate.direction &&
      Math.hypot(...subtract(viewpoint.direction, this.viewpoint.direction)) > 1e-12;
    this.viewpoint = { ...viewpoint, distanceMm };
    this.viewpointGiven = true;
    if (turned) this.upload('relief');
    this.furniture.setAtViewpoint(this.atViewpoint);
    this.invalidate();
  }

  getViewpoint(): Viewpoint {
    return this.viewpoint;
  }

  getCameraAsViewpoint(): Viewpoint {
    return viewpointFromCamera(this.camera, this.screen, this.centre(), this.viewpoint.distanceMm);
  }

  get atViewpoint(): boolean {
    return sameEye(this.camera, this.viewpointCamera(), this.radius());
  }

  lookFromViewpoint(animated = true): void {
    const camera = this.viewpointCamera();
    this.turntable = camera.up;
    this.goTo(this.fitCamera(camera), animated);
    this.fitted = true;
  }

  fit(animated = true): void {
    let camera = this.moving?.to ?? this.camera;
    if (!sameEye(camera, this.viewpointCamera(), this.radius())) {
      // Bring the axis back to the middle of what is shown; at the viewpoint the eye must stay.
      camera = { ...remeasured(camera, this.centre()), target: this.centre(), windowX: 0, windowY: 0 };
    }
    this.goTo(this.fitCamera(camera), animated);
    this.fitted = true;
  }

  orbit(azimuthDeg: number, elevationDeg: number): void {
    this.orbitBy((azimuthDeg * Math.PI) / 180, (elevationDeg * Math.PI) / 180);
  }

  zoom(factor: number): void {
    const { left, top, width, height } = this.screen.free;
    this.zoomBy(factor, left + width / 2, top + height / 2);
  }

  setProjection(projection: Projection): void {
    const camera = remeasured(this.camera, this.centre());
    this.cameraChanged({
      ...camera,
      kappa: projection === 'perspective' ? 1 / this.viewpoint.distanceMm : 0,
    });
  }

  private viewpointCamera(): CameraState {
    return cameraFromViewpoint(this.viewpoint, this.camera.halfHeight);
  }

  private orbitBy(azimuth: number, elevation: number): void {
    this.moving = null;
    this.fitted = false;
    this.cameraChanged(orbited(this.camera, this.turntable, this.pivot ?? this.centre(), azimuth, elevation));
  }

  private zoomBy(factor: number, xPx: number, yPx: number): void {
    this.moving = null;
    this.fitted = false;
    const radius = this.radius();
    const height = Math.min(40 * radius, Math.max(radius / 2000, this.camera.halfHeight / factor));
    this.cameraChanged(zoomed(this.camera, this.screen, this.camera.halfHeight / height, xPx, yPx));
  }

  private goTo(camera: CameraState, animated: boolean): void {
    this.coasting = null;
    this.pivot = null;
    if (!animated || prefersReducedMotion() || this.partNames().length === 0) {
      this.moving = null;
      this.cameraChanged(camera);
    } else {
      this.moving = { from: this.camera, to: camera, since: null };
      this.invalidate();
    }
  }

  private cameraChanged(camera: CameraState): void {
    this.camera = camera;
    const atViewpoint = this.atViewpoint;
    this.furniture.setAtViewpoint(atViewpoint);
    this.options.onViewpointChange?.(this.getCameraAsViewpoint(), atViewpoint);
    this.invalidate();
  }

  private fitCamera(camera: CameraState): CameraState {
    const bounds = this.boundsIn(camera);
    if (!bounds) return camera;
    const dimensioned = this.dimensionsShown();
    const extra = dimensioned ? DIMENSION_PX : 0;
    const { left, top, width, height } = this.screen.free;
    // Lines stand below and to the right: fit into what they leave.
    const free = { left, top, width: width - extra, height: height - extra };
    const inner = fitWindow(camera, { ...this.screen, free }, bounds, FIT_MARGIN_PX);
    const mm = mmPerPixel(inner, { ...this.screen, free });
    return {
      ...inner,
      halfHeight: (mm * height) / 2,
      windowX: inner.windowX + (mm * extra) / 2,
      windowY: inner.windowY - (mm * extra) / 2,
    };
  }

  private refit(): void {
    if (this.moving) this.moving.to = this.fitCamera(this.moving.to);
    else this.camera = this.fitCamera(this.camera);
  }

  private animate(now: number, elapsed: number): boolean {
    if (this.coasting) {
      const [azimuth, elevation] = this.coasting;
      const keep = Math.exp(-elapsed / COAST_MS);
      this.coasting =
        Math.hypot(azimuth, elevation) * keep < 2e-5 ? null : [azimuth * keep, elevation * keep];
      this.orbitBy(azimuth * elapsed, elevation * elapsed);
      return true;
    }
    const { moving } = this;
    if (!moving) return false;
    moving.since ??= now;
    const t = Math.min(1, (now - moving.since) / MOVE_MS);
    const eased = t < 0.5 ? 4 * t * t * t : 1 - (-2 * t + 2) ** 3 / 2;
    if (t >= 1) this.moving = null;
    this.cameraChanged(t >= 1 ? moving.to : blended(moving.from, moving.to, this.centre(), eased));
    return true;
  }

  // Extent of what is shown

  private partNames(): PartName[] {
    const wanted: PartName[] =
      this.mode === 'swipe' ? ['original', 'relief'] : this.mode === 'original' ? ['original'] : ['relief'];
    const there = wanted.filter((name) => this.meshes[name]);
    if (there.length > 0) return there;
    return (['relief', 'original'] as const).filter((name) => this.meshes[name]).slice(0, 1);
  }

  private points(name: PartName): Float32Array {
    const stage = this.stage;
    if (!stage) return new Float32Array(0);
    // The ground reaches far beyond its object; frame the object.
    const mesh = stage.meshOf(name);
    return this.showGround && name === 'original' && mesh
      ? stage.meshSupport(name).points
      : stage.subjectOf(name).support.points;
  }

  private boundsIn(camera: CameraState): Bounds2 | null {
    const stage = this.stage;
    if (!stage) return null;
    let bounds: Bounds2 | null = null;
    for (const name of this.partNames())
      bounds = uniteBounds(bounds, projectedBounds(camera, this.points(name), stage.origin));
    return bounds;
  }

  private centre(): Vec3 {
    const stage = this.stage;
    const name = this.partNames()[0];
    if (!stage || !name) return this.viewpoint.targetMm;
    return add(stage.meshSupport(name).centre, stage.origin);
  }

  private radius(): number {
    const stage = this.stage;
    const name = this.partNames()[0];
    return stage && name ? stage.meshSupport(name).radius : 60;
  }

  private dimensionsShown(): boolean {
    return (
      this.showDimensions &&
      this.plate !== null &&
      this.partNames().includes('relief') &&
      this.screen.width >= 560
    );
  }

  private triangleCount(): number {
    return this.partNames().reduce((n, name) => n + (this.stage?.subjectOf(name).triangleCount ?? 0), 0);
  }

  // Drawing

  private invalidate(): void {
    if (this.statusNow.state === 'ready') this.loop.invalidate();
  }

  private picture(parts: readonly PicturePart[]): Picture {
    const axes =
      this.light.follows === 'camera' ? this.camera : viewerAxes(this.viewpoint.direction, this.viewpoint.up);
    return {
      camera: this.camera,
      screen: this.screen,
      parts,
      towardsLight: towardsLight(this.light, axes),
      lightUp: axes.up,
      lightFront: scale(axes.forward, -1),
      backdrop: true,
      plateShadow: true,
      ground: this.showGround,
    };
  }

  private currentParts(): PicturePart[] {
    const names = this.partNames();
    if (names.length < 2) return names.map((part) => ({ part, from: 0, to: 1 }));
    const split = this.furniture.dividerX / this.screen.width;
    return [
      { part: 'original', from: 0, to: split },
      { part: 'relief', from: split, to: 1 },
    ];
  }

  private draw(): void {
    if (!this.stage || this.statusNow.state !== 'ready') return;
    this.layOut();
    this.stage.renderer.info.reset();
    this.stage.draw(this.picture(this.currentParts()), null, this.canvas.width, this.canvas.height);
    if (this.hoverPending) this.reportHover();
  }

  private refineSamples(): number {
    if (!this.stage?.canRefine || this.options.refine === false || this.partNames().length === 0) return 0;
    return this.stage.software ? 16 : 40;
  }

  private refine(sample: number): void {
    const { stage, canvas } = this;
    if (!stage) return;
    if (this.accumulation?.width !== canvas.width || this.accumulation.height !== canvas.height) {
      this.accumulation?.dispose();
      this.accumulation = new Accumulation(canvas.width, canvas.height);
    }
    stage.draw(
      this.picture(this.currentParts()),
      this.accumulation.frame,
      canvas.width,
      canvas.height,
      sample,
    );
    this.accumulation.add(stage.renderer, sample);
    if (sample >= 7) this.accumulation.show(stage.renderer);
  }

  private layOut(): void {
    const { screen, camera } = this;
    const names = this.partNames();
    const bounds = this.boundsIn(camera);
    const mm = mmPerPixel(camera, screen);
    const middleX = screen.free.left + screen.free.width / 2;
    const middleY = screen.free.top + screen.free.height / 2;
    const extent = bounds && {
      left: middleX + (bounds.minX - camera.windowX) / mm,
      right: middleX + (bounds.maxX - camera.windowX) / mm,
      top: middleY - (bounds.maxY - camera.windowY) / mm,
      bottom: middleY - (bounds.minY - camera.windowY) / mm,
    };
    this.furniture.layOut({
      screen,
      extent,
      swipe: names.length === 2 ? this.swipe : null,
      corners:
        this.dimensionsShown() && this.plate ? plateCorners(plateFrame(this.plate, this.viewpoint)) : null,
      plate: this.plate,
      project: (p) => projectToPixels(camera, screen, p),
    });
  }

  private resized(): void {
    const width = Math.max(1, this.container.clientWidth);
    const height = Math.max(1, this.container.clientHeight);
    this.pixelRatio = Math.min(globalThis.devicePixelRatio || 1, this.options.maximumPixelRatio ?? 2);
    this.screen = makeScreen(width, height, this.insets);
    this.stage?.resize(Math.round(width * this.pixelRatio), Math.round(height * this.pixelRatio));
    if (this.fitted) this.refit();
    // A resized canvas is empty: draw before the browser shows it.
    if (this.statusNow.state === 'ready') this.loop.drawNow();
    this.invalidate();
  }

  renderNow(): void {
    this.loop.drawNow();
  }

  async settled(): Promise<void> {
    await this.loop.settled();
  }

  // Pointer

  private controlTarget(): ControlTarget {
    return {
      press: (event) => {
        let kept = false;
        this.report('down', event, () => (kept = true));
        return kept;
      },
      beginOrbit: (event) => {
        const hit = this.pick(...this.local(event));
        this.pivot = hit?.positionMm ?? this.centre();
      },
      orbitBy: (azimuth, elevation) => this.orbitBy(azimuth, elevation),
      panBy: (dx, dy) => {
        this.moving = null;
        this.fitted = false;
        this.cameraChanged(panned(this.camera, this.screen, dx, dy));
      },
      zoomBy: (factor, x, y) => this.zoomBy(factor, x, y),
      release: (event, clicked) => {
        this.report('up', event);
        if (clicked) this.report('click', event);
      },
      hover: (event) => {
        const [xPx, yPx] = this.local(event);
        this.pointer = { event, xPx, yPx };
        this.hoverLater();
      },
      leave: () => {
        this.pointer = null;
        this.furniture.clearValue();
        this.options.onPointer?.({
          kind: 'leave',
          hit: null,
          button: -1,
          shiftKey: false,
          ctrlKey: false,
          capture: () => undefined,
        });
      },
      command: (name) => (name === 'viewpoint' ? this.lookFromViewpoint() : this.fit()),
      dragging: (active) => {
        this.root.toggleAttribute('data-dragging', active);
        if (active) this.furniture.clearValue();
      },
      coast: (azimuth, elevation) => {
        if (prefersReducedMotion() || Math.hypot(azimuth, elevation) < 2e-4) return;
        this.coasting = [azimuth, elevation];
        this.invalidate();
      },
      stopCoasting: () => {
        this.coasting = null;
        this.pivot = null;
      },
    };
  }

  private local(event: { clientX: number; clientY: number }): [number, number] {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  /** Hovering asks at most once a frame, and costs no drawing. */
  private hoverLater(): void {
    if (this.hoverPending || !this.pointer) return;
    this.hoverPending = true;
    requestAnimationFrame(() => this.reportHover());
  }

  private reportHover(): void {
    this.hoverPending = false;
    if (!this.pointer) return;
    const hit = this.report('move', this.pointer.event);
    const mapping = this.mapping;
    if (hit && hit.value !== null && mapping) this.furniture.showValue(hit, mapping);
    else this.furniture.clearValue();
  }

  private report(
    kind: 'move' | 'down' | 'up' | 'click',
    event: PointerEvent,
    capture: () => void = () => undefined,
  ): Hit | null {
    const mapped = this.mapping !== null && (this.mode === 'error' || this.mappingAlways);
    if (!this.options.onPointer && !mapped) return null;
    const hit = this.pick(...this.local(event));
    this.options.onPointer?.({
      kind,
      hit,
      button: event.button,
      shiftKey: event.shiftKey,
      ctrlKey: event.ctrlKey,
      capture,
    });
    return hit;
  }

  pick(xPx: number, yPx: number): Hit | null {
    const { stage } = this;
    if (!stage) return null;
    const fraction = xPx / this.screen.width;
    const shown = this.currentParts().find((p) => fraction >= p.from && fraction < p.to);
    if (!shown) return null;
    const subject = stage.subjectOf(shown.part).support;
    const ray = rayThroughPixel(
      this.camera,
      this.screen,
      xPx,
      yPx,
      4 * subject.radius + Math.hypot(...subtract(this.camera.target, add(subject.centre, stage.origin))),
    );
    const origin = subtract(ray.origin, stage.origin);
    const cut = this.cutTest();
    let best: Hit | null = null;
    let nearest = Infinity;
    const mesh = stage.meshOf(shown.part);
    const solids = [
      ...(mesh ? [mesh] : []),
      ...(shown.part === 'relief' ? stage.plateSurfaces('relief') : []),
    ];
    for (const surface of solids) {
      const hit = this.picker.cast(surface, origin, ray.direction, cut ?? undefined);
      if (!hit || hit.distance >= nearest) continue;
      nearest = hit.distance;
      const onMesh = surface === mesh;
      best = {
        part: onMesh ? shown.part : 'plate',
        positionMm: add(hit.point, stage.origin),
        normal: hit.normal,
        triangle: onMesh ? hit.triangle : -1,
        barycentric: hit.barycentric,
        value: onMesh ? valueAt(surface.scalarValues, surface.indices, hit.triangle, hit.barycentric) : null,
        xPx,
        yPx,
      };
    }
    return best;
  }

  private cutTest(): ((p: Vec3) => boolean) | null {
    const uniform = this.stage?.picture['uSection']?.value as
      { x: number; y: number; z: number; w: number } | undefined;
    if (!this.section || !uniform) return null;
    return (p) => uniform.x * p[0] + uniform.y * p[1] + uniform.z * p[2] <= uniform.w;
  }

  project(positionMm: Vec3): { xPx: number; yPx: number } | null {
    return projectToPixels(this.camera, this.screen, positionMm);
  }

  // Pictures

  async snapshot(widthPx: number, heightPx: number, options: { transparent?: boolean } = {}): Promise<Blob> {
    const { stage } = this;
    if (!stage || this.statusNow.state !== 'ready')
      throw new Error('There is no picture to keep: the 3D view is not running.');
    while (stage.bakePendingFor(this.partNames())) stage.bake(80, this.partNames());
    const factor = Math.min(widthPx / this.screen.width, heightPx / this.screen.height);
    // The whole viewport inside the picture; what lies beyond its edges fills the rest.
    const screen = makeScreen(widthPx / factor, heightPx / factor, { left: 0, top: 0, right: 0, bottom: 0 });
    const mm = mmPerPixel(this.camera, this.screen);
    const dx = this.screen.width / 2 - (this.screen.free.left + this.screen.free.width / 2);
    const dy = this.screen.height / 2 - (this.screen.free.top + this.screen.free.height / 2);
    const camera = {
      ...this.camera,
      windowX: this.camera.windowX + dx * mm,
      windowY: this.camera.windowY - dy * mm,
      halfHeight: (mm * screen.height) / 2,
    };
    const shift = (x: number): number =>
      x === 0 || x === 1 ? x : 0.5 + ((x - 0.5) * this.screen.width) / screen.width;
    const parts = this.currentParts().map((p) => ({ ...p, from: shift(p.from), to: shift(p.to) }));
    const picture = { ...this.picture(parts), camera, screen, backdrop: !options.transparent };
    const pixels = await stage.read(picture, widthPx, heightPx, 24);
    this.invalidate();
    return encodePng(pixels, widthPx, heightPx);
  }

  /** For the side view: pictures of the relief through another camera. */
  async readPart(
    part: PartName,
    camera: (centre: Vec3, radius: number) => CameraState,
    width: number,
    height: number,
    samples: number,
  ): Promise<Uint8ClampedArray<ArrayBuffer> | null> {
    const { stage } = this;
    if (!stage || !this.meshes[part] || this.statusNow.state !== 'ready') return null;
    const support = stage.subjectOf(part).support;
    const screen = makeScreen(width, height, { left: 0, top: 0, right: 0, bottom: 0 });
    let view = camera(add(support.centre, stage.origin), support.radius);
    const bounds = projectedBounds(view, support.points, stage.origin);
    if (bounds) view = fitWindow(view, screen, bounds, 0.09 * height);
    const picture = {
      ...this.picture([{ part, from: 0, to: 1 }]),
      camera: view,
      screen,
      plateShadow: false,
      ground: false,
    };
    const pixels = await stage.read(picture, width, height, samples);
    this.loop.restart();
    return pixels;
  }

  // Status

  private setStatus(status: ViewStatus): void {
    this.statusNow = status;
    this.furniture.setMessage(status.state === 'ready' ? null : status.message);
    this.options.onStatus?.(status);
  }

  private readonly contextLost = (event: Event): void => {
    event.preventDefault();
    this.loop.stop();
    this.accumulation?.dispose();
    this.accumulation = null;
    this.stage?.forgetGpu();
    this.setStatus({ state: 'lost', message: LOST });
  };

  private readonly contextRestored = (): void => {
    this.setStatus({ state: 'ready' });
    this.loop.start();
  };

  dispose(): void {
    this.loop.stop();
    this.controls.dispose();
    this.picker.dispose();
    this.resizing.disconnect();
    this.themeWatch.disconnect();
    this.canvas.removeEventListener('webglcontextlost', this.contextLost);
    this.canvas.removeEventListener('webglcontextrestored', this.contextRestored);
    this.accumulation?.dispose();
    this.stage?.dispose();
    // Browsers keep few contexts: give this one back now, not when memory is next collected.
    this.stage?.renderer.forceContextLoss();
    this.stage = null;
    this.root.remove();
  }
}

function valueAt(
  values: Float32Array | null,
  indices: Uint32Array,
  triangle: number,
  weights: Vec3,
): number | null {
  if (!values || triangle < 0) return null;
  let sum = 0;
  for (let k = 0; k < 3; ++k)
    sum += (weights[k] as number) * (values[indices[3 * triangle + k] as number] as number);
  return Number.isFinite(sum) ? sum : null;
}

function samePlate(a: Plate | null, b: Plate | null): boolean {
  if (!a || !b) return a === b;
  const { reliefThicknessMm: _a, ...restA } = a;
  const { reliefThicknessMm: _b, ...restB } = b;
  return (
    JSON.stringify({ ...restA, mesh: null }) === JSON.stringify({ ...restB, mesh: null }) &&
    restA.mesh === restB.mesh
  );
}
