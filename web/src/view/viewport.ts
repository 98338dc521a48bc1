// SPDX-License-Identifier: GPL-3.0-or-later
// The viewport: the calls of `api.ts`, joined to what is shown (`content.ts`), the camera (`camera_rig.ts`),
// the drawing (`stage.ts`), when to draw (`frame_loop.ts`) and the elements on top (`furniture.ts`).
import './view.css';
import type {
  ColourMapping,
  Curve,
  Fixture,
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
  type CameraState,
  cameraFromViewpoint,
  makeScreen,
  projectToPixels,
  rayThroughPixel,
} from './camera/camera';
import { CameraRig } from './camera/camera_rig';
import { Content } from './content';
import { Controls } from './camera/controls';
import { FrameLoop } from './render/frame_loop';
import { Furniture } from './overlay/furniture';
import { DEFAULT_LIGHT, towardsLight } from './render/light';
import { Painter } from './render/painter';
import { Picker } from './pick/picker';
import { pickAt } from './pick/picking';
import { plateCorners, plateFrame } from './overlay/plate';
import { encodePng } from './render/png';
import { PointerReports } from './camera/pointer';
import { readPart, readView } from './render/snapshot';
import { type PartName, type Picture, type PicturePart, Stage } from './render/stage';
import { qualityHere } from './render/quality';
import { readPalette } from './theme';
import { length, scale, subtract, viewerAxes } from './vector';

const UNSUPPORTED =
  'This browser cannot draw in 3D: it offers no WebGL 2. Update the browser, or allow hardware acceleration in its settings.';
const LOST =
  'The graphics context was lost. The view will be restored in a moment; if it is not, reload the page.';

/** Room for dimension lines below and to the right, px; narrower viewports go without. */
const DIMENSION_PX = 30;
const DIMENSION_LEAST_WIDTH = 560;
const NO_INSETS: Insets = { left: 0, top: 0, right: 0, bottom: 0 };

export class Viewport implements ViewportApi {
  readonly canvas = document.createElement('canvas');
  readonly overlay: HTMLDivElement;
  private readonly root = document.createElement('div');
  private readonly furniture: Furniture;
  private readonly rig: CameraRig;
  private readonly picker: Picker;
  private readonly pointer: PointerReports;
  private readonly controls: Controls;
  private readonly loop: FrameLoop;
  private readonly resizing: ResizeObserver;
  private readonly themeWatch: MutationObserver;
  /** Both null where WebGL 2 is missing: every call then does nothing. */
  private stage: Stage | null = null;
  private content: Content | null = null;
  private painter: Painter | null = null;
  private statusNow: ViewStatus = { state: 'ready' };
  private light: LightDirection;
  private theme: Theme;
  private insets: Insets;
  private showDimensions: boolean;
  private swipe = 0.5;

  constructor(
    private readonly container: HTMLElement,
    private readonly options: ViewportOptions = {},
  ) {
    this.light = options.light ?? DEFAULT_LIGHT;
    this.theme = options.theme ?? 'auto';
    this.insets = options.freeRectangle ?? NO_INSETS;
    this.showDimensions = options.dimensions ?? true;
    this.furniture = new Furniture(this.root, options.partNames ?? ['Original', 'Relief'], (position) => {
      this.setSwipe(position);
      options.onSwipe?.(position);
    });
    this.overlay = this.furniture.element;
    this.buildRoot();
    this.rig = new CameraRig(
      {
        // All of it in every mode: going from one to the other must not move the picture.
        bounds: (camera) => this.content?.bounds(camera, 'all') ?? null,
        centre: () => this.content?.centre() ?? this.rig.viewpoint.targetMm,
        radius: () => this.content?.radius() ?? 60,
        upright: options.uprightTurn ?? false,
        extraPx: () => (this.hasDimensions() ? DIMENSION_PX : 0),
      },
      () => this.cameraChanged(),
    );
    this.loop = this.makeLoop();
    this.picker = new Picker(() => this.pointer.hoverLater());
    this.pointer = this.makePointer();
    this.controls = new Controls(this.root, this.canvas, this.pointer.target());
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
      const stage = new Stage(this.canvas, qualityHere());
      stage.setPalette(readPalette(this.theme, this.root));
      const mode = options.mode ?? 'original';
      this.content = new Content(
        stage,
        this.picker,
        () => this.rig,
        mode,
        options.ground ?? false,
        this.root,
      );
      this.stage = stage;
      this.painter = new Painter(stage, this.canvas);
    } catch {
      this.setStatus({ state: 'unsupported', message: UNSUPPORTED });
    }
    this.resized();
  }

  private buildRoot(): void {
    const { root } = this;
    root.className = 'fw-view';
    root.tabIndex = 0;
    root.setAttribute('role', 'application');
    root.setAttribute('aria-roledescription', '3D view');
    root.setAttribute('aria-label', this.options.label ?? 'Viewport');
    root.setAttribute('aria-keyshortcuts', 'ArrowLeft ArrowRight ArrowUp ArrowDown + - 0 F');
    this.canvas.setAttribute('aria-hidden', 'true');
    root.append(this.canvas, this.overlay);
    this.container.append(root);
  }

  private makeLoop(): FrameLoop {
    const parts = (): PartName[] => this.content?.parts() ?? [];
    return new FrameLoop(
      {
        animate: (now, elapsed) => this.rig.animate(now, elapsed),
        draw: () => this.draw(),
        present: () => this.painter?.present() ?? false,
        bakePending: () => this.stage?.bakePendingFor(parts()) ?? false,
        bake: () => {
          const finished = this.stage?.bake(parts()) ?? false;
          this.stage?.pace.mark();
          return finished;
        },
        refineSamples: () => {
          if (!this.stage?.canRefine || this.options.refine === false || parts().length === 0) return 0;
          return this.stage.quality.stillSamples;
        },
        refine: (sample) => this.painter?.refine(this.picture(this.pictureParts()), sample),
        gpuBusy: () => this.stage?.busy ?? false,
        triangles: () => this.content?.triangleCount() ?? 0,
        onFrame: (stats) => this.options.onFrame?.(stats),
      },
      qualityHere().restMs,
    );
  }

  private makePointer(): PointerReports {
    return new PointerReports({
      canvas: this.canvas,
      rig: this.rig,
      pick: (x, y) => this.pick(x, y),
      wanted: () => this.options.onPointer !== undefined || (this.content?.mapped ?? false),
      onPointer: (event) => this.options.onPointer?.(event),
      showValue: (hit) => {
        const mapping = this.content?.mapping;
        if (hit && hit.value !== null && mapping) this.furniture.showValue(hit, mapping);
        else this.furniture.clearValue();
      },
      command: (name) => {
        if (name === 'viewpoint') this.lookFromViewpoint();
        else this.fit();
      },
      dragging: (active) => void this.root.toggleAttribute('data-dragging', active),
    });
  }

  get status(): ViewStatus {
    return this.statusNow;
  }

  // Meshes

  setOriginal(mesh: MeshData | null): void {
    this.shapeChanged(this.content?.setOriginal(mesh) ?? false);
  }

  setRelief(mesh: MeshData | null, plate: Plate | null): void {
    this.shapeChanged(this.content?.setRelief(mesh, plate) ?? false);
  }

  updateOriginal(positions: Float32Array | Float64Array): void {
    this.content?.update('original', positions);
    this.shapeChanged(false);
  }

  rescaleOriginal(positions: Float32Array | Float64Array): void {
    this.content?.update('original', positions, undefined, true);
    this.shapeChanged(false);
  }

  updateRelief(positions: Float32Array | Float64Array, plate?: Plate | null): void {
    this.content?.update('relief', positions, plate);
    this.shapeChanged(false);
  }

  updateAttribute(part: PartName, name: string, values: Float32Array): void {
    this.stage?.colouring.setAttribute(part, name, values);
    this.invalidate();
  }

  setFixtures(fixtures: readonly Fixture[]): void {
    this.content?.setFixtures(fixtures);
    this.shapeChanged(false);
  }

  moveFixture(id: string, positions: Float32Array | Float64Array): void {
    this.stage?.moveFixture(id, positions);
    this.shapeChanged(false);
  }

  setOpacity(part: PartName, opacity: number): void {
    this.stage?.setOpacity(part, opacity);
    this.invalidate();
  }

  private shapeChanged(first: boolean): void {
    if (first) this.rig.begin();
    else this.rig.refit();
    this.furniture.clearValue();
    this.invalidate();
  }

  // What is shown

  setMode(mode: ViewMode): void {
    if (!this.content || mode === this.content.mode) return;
    this.content.setMode(mode);
    this.furniture.clearValue();
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
    this.content?.setMapping(mapping, always);
    this.furniture.clearValue();
    this.invalidate();
  }

  setErrorRange(minimum: number, maximum: number): void {
    this.content?.setRange(minimum, maximum);
    this.invalidate();
  }

  setSection(section: Section | null): void {
    this.content?.setSection(section);
    this.invalidate();
  }

  setCurves(curves: readonly Curve[]): void {
    this.content?.setCurves(curves);
    this.invalidate();
  }

  get linePieces(): number {
    return qualityHere().linePieces;
  }

  setReach(value: number | null): void {
    this.stage?.setReach(value);
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
    this.stage?.setPalette(readPalette(this.theme, this.root));
    this.content?.refresh();
    this.invalidate();
  }

  setFreeRectangle(insets: Insets): void {
    this.insets = insets;
    this.resized();
  }

  setDimensionsVisible(visible: boolean): void {
    this.showDimensions = visible;
    this.rig.refit();
    this.invalidate();
  }

  setGround(visible: boolean): void {
    this.content?.setGround(visible);
    this.shapeChanged(false);
  }

  // Camera

  setViewpoint(viewpoint: Viewpoint): void {
    const before = this.rig.viewpoint;
    this.rig.setViewpoint(viewpoint);
    const turned =
      length(subtract(before.direction, viewpoint.direction)) > 1e-12 ||
      length(subtract(before.up, viewpoint.up)) > 1e-12;
    if (turned) this.content?.viewpointTurned();
    this.furniture.setAtViewpoint(this.rig.atViewpoint);
    this.invalidate();
  }

  getViewpoint(): Viewpoint {
    return this.rig.viewpoint;
  }

  getCameraAsViewpoint(): Viewpoint {
    return this.rig.asViewpoint();
  }

  get atViewpoint(): boolean {
    return this.rig.atViewpoint;
  }

  lookFromViewpoint(animated = true): void {
    this.rig.lookFromViewpoint(animated && this.content?.centre() !== null);
  }

  fit(animated = true): void {
    this.rig.fit(animated && this.content?.centre() !== null);
  }

  orbit(azimuthDeg: number, elevationDeg: number): void {
    this.rig.orbitBy((azimuthDeg * Math.PI) / 180, (elevationDeg * Math.PI) / 180);
  }

  zoom(factor: number): void {
    const { left, top, width, height } = this.rig.screen.free;
    this.rig.zoomBy(factor, left + width / 2, top + height / 2);
  }

  setProjection(projection: Projection): void {
    this.rig.setProjection(projection);
  }

  private cameraChanged(): void {
    const { atViewpoint } = this.rig;
    this.furniture.setAtViewpoint(atViewpoint);
    this.options.onViewpointChange?.(this.rig.asViewpoint(), atViewpoint);
    this.invalidate();
  }

  pick(xPx: number, yPx: number): Hit | null {
    const { camera, screen } = this.rig;
    return this.stage ? pickAt(this.stage, this.picker, camera, screen, this.pictureParts(), xPx, yPx) : null;
  }

  rayThrough(xPx: number, yPx: number): { originMm: Vec3; direction: Vec3 } {
    const { camera, screen } = this.rig;
    const reach = 10 * (this.content?.radius() ?? 60);
    const { origin, direction } = rayThroughPixel(camera, screen, xPx, yPx, reach);
    return { originMm: origin, direction };
  }

  project(positionMm: Vec3): { xPx: number; yPx: number } | null {
    return projectToPixels(this.rig.camera, this.rig.screen, positionMm);
  }

  // Drawing

  private invalidate(): void {
    if (this.statusNow.state === 'ready') this.loop.invalidate();
  }

  private hasDimensions(): boolean {
    const wide = this.rig.screen.width >= DIMENSION_LEAST_WIDTH;
    return (
      this.showDimensions && wide && Boolean(this.content?.plate) && Boolean(this.content?.meshes.relief)
    );
  }

  private picture(parts: readonly PicturePart[]): Picture {
    const { camera, screen, viewpoint } = this.rig;
    const axes = this.light.follows === 'camera' ? camera : viewerAxes(viewpoint.direction, viewpoint.up);
    return {
      camera,
      screen,
      parts,
      towardsLight: towardsLight(this.light, axes),
      lightUp: axes.up,
      lightFront: scale(axes.forward, -1),
      backdrop: true,
      plateShadow: true,
      ground: this.content?.ground ?? false,
    };
  }

  private pictureParts(): PicturePart[] {
    const names = this.content?.parts() ?? [];
    if (names.length < 2) return names.map((part) => ({ part, from: 0, to: 1 }));
    const split = this.furniture.dividerX / this.rig.screen.width;
    return [
      { part: 'original', from: 0, to: split },
      { part: 'relief', from: split, to: 1 },
    ];
  }

  private draw(): void {
    if (this.statusNow.state !== 'ready') return;
    this.layOut();
    this.painter?.draw(this.picture(this.pictureParts()));
  }

  private layOut(): void {
    const { content } = this;
    if (!content) return;
    const { camera, screen, viewpoint } = this.rig;
    const { plate } = content;
    this.furniture.layOut({
      screen,
      extent: this.rig.extentPx(content.bounds(camera, 'shown')),
      swipe: content.parts().length === 2 ? this.swipe : null,
      corners:
        plate && this.hasDimensions() && content.parts().includes('relief')
          ? plateCorners(plateFrame(plate, viewpoint))
          : null,
      plate,
      project: (p) => projectToPixels(camera, screen, p),
    });
  }

  private resized(): void {
    const width = Math.max(1, this.container.clientWidth);
    const height = Math.max(1, this.container.clientHeight);
    const ratio = Math.min(
      globalThis.devicePixelRatio || 1,
      this.options.maximumPixelRatio ?? qualityHere().pixelRatio,
    );
    this.rig.screen = makeScreen(width, height, this.insets);
    const [columns, rows] = [Math.round(width * ratio), Math.round(height * ratio)];
    const emptied = this.canvas.width !== columns || this.canvas.height !== rows;
    if (emptied) this.stage?.resize(columns, rows, ratio);
    this.rig.refit();
    // A resized canvas is empty: draw before the browser shows it.
    if (emptied && this.statusNow.state === 'ready') this.loop.drawNow();
    this.invalidate();
  }

  setResting(resting: boolean): void {
    if (qualityHere().yieldsToWork) this.loop.setHeld(resting);
  }

  renderNow(): void {
    this.loop.drawNow();
  }

  async settled(): Promise<void> {
    await this.loop.settled();
  }

  async snapshot(widthPx: number, heightPx: number, options: { transparent?: boolean } = {}): Promise<Blob> {
    const { stage } = this;
    if (!stage || this.statusNow.state !== 'ready') {
      throw new Error('The picture cannot be saved because the 3D view is not running: reload the page.');
    }
    const picture = { ...this.picture(this.pictureParts()), backdrop: !options.transparent };
    const pixels = await readView(stage, picture, widthPx, heightPx);
    this.invalidate();
    return encodePng(pixels, widthPx, heightPx);
  }

  /** A part through another camera, r, g, b, a bytes; null while there is nothing to draw. For the side view. */
  async readPart(
    part: PartName,
    camera: (centre: Vec3, radius: number) => CameraState,
    width: number,
    height: number,
  ): Promise<Uint8ClampedArray<ArrayBuffer> | null> {
    const { stage, content } = this;
    if (!stage || !content?.meshes[part] || this.statusNow.state !== 'ready') return null;
    const pixels = await readPart(stage, this.picture([]), part, camera, width, height);
    this.loop.restart();
    return pixels;
  }

  async pictureOf(
    part: PartName,
    look: Pick<Viewpoint, 'direction' | 'up'>,
    widthPx: number,
    heightPx: number,
  ): Promise<Blob | null> {
    const camera = (targetMm: Vec3, radius: number): CameraState =>
      cameraFromViewpoint(
        { projection: 'perspective', targetMm, distanceMm: 6 * radius, fieldOfViewDeg: 20, ...look },
        radius,
      );
    const pixels = await this.readPart(part, camera, widthPx, heightPx);
    return pixels && (await encodePng(pixels, widthPx, heightPx));
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
    this.painter?.dispose();
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
    this.pointer.dispose();
    this.picker.dispose();
    this.resizing.disconnect();
    this.themeWatch.disconnect();
    this.canvas.removeEventListener('webglcontextlost', this.contextLost);
    this.canvas.removeEventListener('webglcontextrestored', this.contextRestored);
    this.painter?.dispose();
    this.stage?.dispose();
    // Browsers keep few contexts: give this one back now, not when memory is next collected.
    this.stage?.renderer.forceContextLoss();
    this.stage = this.content = null;
    this.root.remove();
  }
}
