// SPDX-License-Identifier: GPL-3.0-or-later
// What a viewport is made of, and when it is drawn: what is shown (`content.ts`), the camera (`camera_rig.ts`),
// the graphics card (`stage.ts`), the frames (`frame_loop.ts`), the elements on top (`furniture.ts`), the size,
// the theme and the loss of the graphics context.
import './view.css';
import type { Hit, Insets, Theme, ViewportOptions, ViewStatus } from './api';
import { makeScreen } from './camera/camera';
import { CameraRig } from './camera/camera_rig';
import { Controls } from './camera/controls';
import { PointerReports } from './camera/pointer';
import { Composition } from './composition';
import { Content } from './content';
import { Furniture } from './overlay/furniture';
import { Picker } from './pick/picker';
import { pickAt } from './pick/picking';
import { FrameLoop } from './render/frame_loop';
import { DEFAULT_LIGHT } from './render/light';
import { Painter } from './render/painter';
import type { PartName } from './render/part';
import { qualityHere } from './render/quality';
import { Stage } from './render/stage';
import { readPalette } from './theme';

const UNSUPPORTED =
  'This browser cannot draw in 3D: it offers no WebGL 2. Update the browser, or allow hardware acceleration in its settings.';
const LOST =
  'The graphics context was lost. The view will be restored in a moment; if it is not, reload the page.';

/** Room for dimension lines below and to the right, px. */
const DIMENSION_PX = 30;
const NO_INSETS: Insets = { left: 0, top: 0, right: 0, bottom: 0 };

export abstract class ViewportBase {
  readonly canvas = document.createElement('canvas');
  readonly overlay: HTMLDivElement;
  protected readonly furniture: Furniture;
  protected readonly rig: CameraRig;
  protected readonly loop: FrameLoop;
  protected readonly composition: Composition;
  /** All three null where WebGL 2 is missing: every call then does nothing. */
  protected stage: Stage | null = null;
  protected content: Content | null = null;
  private painter: Painter | null = null;
  private readonly root = document.createElement('div');
  private readonly picker: Picker;
  private readonly pointer: PointerReports;
  private readonly controls: Controls;
  private readonly resizing: ResizeObserver;
  private readonly themeWatch: MutationObserver;
  private statusNow: ViewStatus = { state: 'ready' };
  private theme: Theme;
  private insets: Insets;

  constructor(
    private readonly container: HTMLElement,
    protected readonly options: ViewportOptions = {},
  ) {
    this.theme = options.theme ?? 'auto';
    this.insets = options.freeRectangle ?? NO_INSETS;
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
        extraPx: () => (this.composition.hasDimensions() ? DIMENSION_PX : 0),
      },
      () => this.cameraChanged(),
    );
    this.composition = new Composition(
      this.rig,
      this.furniture,
      () => this.content,
      options.light ?? DEFAULT_LIGHT,
      options.dimensions ?? true,
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
      const ground = options.ground ?? false;
      this.content = new Content(stage, this.picker, () => this.rig, mode, ground, this.root);
      this.stage = stage;
      this.painter = new Painter(stage, this.canvas);
    } catch {
      this.setStatus({ state: 'unsupported', message: UNSUPPORTED });
    }
    this.resized();
  }

  abstract lookFromViewpoint(animated?: boolean): void;
  abstract fit(animated?: boolean): void;

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
        refine: (sample) => this.painter?.refine(this.composition.picture(this.composition.parts()), sample),
        gpuBusy: () => this.stage?.busy ?? false,
        triangles: () => this.content?.triangleCount() ?? 0,
        onFrame: (stats) => this.options.onFrame?.(stats),
        onDrawing: (drawing) => void this.root.toggleAttribute('data-drawing', drawing),
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

  pick(xPx: number, yPx: number): Hit | null {
    const { camera, screen } = this.rig;
    const { stage, picker, composition } = this;
    return stage ? pickAt(stage, picker, camera, screen, composition.parts(), xPx, yPx) : null;
  }

  get preparingPick(): boolean {
    return this.picker.busy;
  }

  setSwipe(position: number): void {
    this.composition.swipe = Math.min(1, Math.max(0, position));
    this.invalidate();
  }

  setPartNames(names: readonly [original: string, relief: string]): void {
    this.furniture.setPartNames(names);
  }

  protected invalidate(): void {
    if (this.statusNow.state === 'ready') this.loop.invalidate();
  }

  /** `first`: the first mesh there is. */
  protected shapeChanged(first: boolean): void {
    if (first) this.rig.begin();
    else this.rig.refit();
    this.furniture.clearValue();
    this.invalidate();
  }

  private cameraChanged(): void {
    const { atViewpoint } = this.rig;
    this.furniture.setAtViewpoint(atViewpoint);
    this.options.onViewpointChange?.(this.rig.asViewpoint(), atViewpoint);
    this.invalidate();
  }

  private draw(): void {
    if (this.statusNow.state !== 'ready') return;
    this.composition.layOut();
    this.painter?.draw(this.composition.picture(this.composition.parts()));
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
