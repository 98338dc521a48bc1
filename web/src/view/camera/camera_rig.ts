// SPDX-License-Identifier: GPL-3.0-or-later
// The camera in hand: viewpoint, orbit, pan, zoom, fitting, and the moves between.
import type { Projection, Vec3, Viewpoint } from '../api';
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
  remeasured,
  sameEye,
  viewpointFromCamera,
  zoomed,
} from './camera';
import type { Extent } from '../overlay/swipe_divider';
import { prefersReducedMotion } from '../theme';
import { normalise } from '../vector';

/** What is framed. */
export interface Framed {
  bounds(camera: CameraState): Bounds2 | null;
  centre(): Vec3;
  radius(): number;
  /** What turning keeps upright: the viewpoint's own up, or up in its picture. */
  upright: boolean;
  /** Room that dimension lines need below and to the right, px. */
  extraPx(): number;
}

const DEFAULT_VIEWPOINT: Viewpoint = {
  projection: 'orthographic',
  direction: [0, 0, -1],
  up: [0, 1, 0],
  targetMm: [0, 0, 0],
  distanceMm: 500,
  fieldOfViewDeg: 20,
};

/** Coasting fades with this time, ms. */
const COAST_MS = 80;
/** A flick turns on by 14 degrees at most; radians per ms. */
const FASTEST_COAST = 0.003;
const MOVE_MS = 360;
const FIT_MARGIN_PX = 16;

export class CameraRig {
  camera: CameraState = cameraFromViewpoint(DEFAULT_VIEWPOINT, 60);
  screen: Screen = makeScreen(1, 1, { left: 0, top: 0, right: 0, bottom: 0 });
  viewpoint: Viewpoint = DEFAULT_VIEWPOINT;
  private viewpointGiven = false;
  /** The window was fitted and nobody touched it: keep fitting when shapes or the screen change. */
  private fitted = true;
  private turntable: Vec3 = [0, 1, 0];
  private pivot: Vec3 | null = null;
  private moving: { from: CameraState; to: CameraState; since: number | null } | null = null;
  private coasting: [number, number] | null = null;

  constructor(
    private readonly framed: Framed,
    private readonly onChange: () => void,
  ) {}

  setViewpoint(viewpoint: Viewpoint): void {
    const half = (Math.min(120, Math.max(0.1, viewpoint.fieldOfViewDeg)) * Math.PI) / 360;
    const distanceMm =
      viewpoint.distanceMm > 0 ? viewpoint.distanceMm : this.framed.radius() / Math.tan(half);
    this.viewpoint = { ...viewpoint, distanceMm };
    this.viewpointGiven = true;
  }

  /** The first mesh is there: look at it, from the viewpoint if one was given. */
  begin(): void {
    if (!this.viewpointGiven) this.viewpoint = { ...this.viewpoint, targetMm: this.framed.centre() };
    this.lookFromViewpoint(false);
  }

  asViewpoint(): Viewpoint {
    return viewpointFromCamera(this.camera, this.screen, this.framed.centre(), this.viewpoint.distanceMm);
  }

  get atViewpoint(): boolean {
    return sameEye(this.camera, this.viewpointCamera(), this.framed.radius());
  }

  private viewpointCamera(): CameraState {
    return cameraFromViewpoint(this.viewpoint, this.camera.halfHeight);
  }

  get mmPerPx(): number {
    return mmPerPixel(this.camera, this.screen);
  }

  /** Bounds on the target's plane as an extent on the viewport, CSS px. */
  extentPx(bounds: Bounds2 | null): Extent | null {
    if (!bounds) return null;
    const { camera, screen, mmPerPx: mm } = this;
    const middleX = screen.free.left + screen.free.width / 2;
    const middleY = screen.free.top + screen.free.height / 2;
    return {
      left: middleX + (bounds.minX - camera.windowX) / mm,
      right: middleX + (bounds.maxX - camera.windowX) / mm,
      top: middleY - (bounds.maxY - camera.windowY) / mm,
      bottom: middleY - (bounds.minY - camera.windowY) / mm,
    };
  }

  lookFromViewpoint(animated: boolean): void {
    const camera = this.viewpointCamera();
    this.turntable = this.framed.upright ? normalise(this.viewpoint.up) : camera.up;
    this.fitted = true;
    this.goTo(this.fitCamera(camera), animated);
  }

  fit(animated: boolean): void {
    let camera = this.moving?.to ?? this.camera;
    if (!sameEye(camera, this.viewpointCamera(), this.framed.radius())) {
      // Bring the axis back to the middle of what is shown; at the viewpoint the eye must stay.
      const centre = this.framed.centre();
      camera = { ...remeasured(camera, centre), target: centre, windowX: 0, windowY: 0 };
    }
    this.fitted = true;
    this.goTo(this.fitCamera(camera), animated);
  }

  setProjection(projection: Projection): void {
    const camera = remeasured(this.camera, this.framed.centre());
    this.change({ ...camera, kappa: projection === 'perspective' ? 1 / this.viewpoint.distanceMm : 0 });
  }

  /** The point about which the hand turns; null is the middle of what is shown. */
  setPivot(pivot: Vec3 | null): void {
    this.pivot = pivot;
  }

  orbitBy(azimuth: number, elevation: number): void {
    this.touched();
    const pivot = this.pivot ?? this.framed.centre();
    this.change(orbited(this.camera, this.turntable, pivot, azimuth, elevation));
  }

  panBy(dxPx: number, dyPx: number): void {
    this.touched();
    this.change(panned(this.camera, this.screen, dxPx, dyPx));
  }

  zoomBy(factor: number, xPx: number, yPx: number): void {
    this.touched();
    const radius = this.framed.radius();
    const height = Math.min(40 * radius, Math.max(radius / 2000, this.camera.halfHeight / factor));
    this.change(zoomed(this.camera, this.screen, this.camera.halfHeight / height, xPx, yPx));
  }

  coast(azimuthRate: number, elevationRate: number): void {
    const rate = Math.hypot(azimuthRate, elevationRate);
    if (prefersReducedMotion() || rate < 2e-4) return;
    const slower = Math.min(1, FASTEST_COAST / rate);
    this.coasting = [slower * azimuthRate, slower * elevationRate];
    this.onChange();
  }

  stopCoasting(): void {
    this.coasting = null;
    this.pivot = null;
  }

  private touched(): void {
    this.moving = null;
    this.fitted = false;
  }

  private change(camera: CameraState): void {
    this.camera = camera;
    this.onChange();
  }

  private goTo(camera: CameraState, animated: boolean): void {
    this.stopCoasting();
    if (!animated || prefersReducedMotion()) {
      this.moving = null;
      this.change(camera);
    } else {
      this.moving = { from: this.camera, to: camera, since: null };
      this.onChange();
    }
  }

  /** Shapes or the screen changed: frame them again, unless the maker chose another window. */
  refit(): void {
    if (!this.fitted) return;
    if (this.moving) this.moving.to = this.fitCamera(this.moving.to);
    else this.camera = this.fitCamera(this.camera);
  }

  private fitCamera(camera: CameraState): CameraState {
    const bounds = this.framed.bounds(camera);
    if (!bounds) return camera;
    const extra = this.framed.extraPx();
    const { left, top, width, height } = this.screen.free;
    const inner: Screen = {
      ...this.screen,
      free: { left, top, width: Math.max(1, width - extra), height: Math.max(1, height - extra) },
    };
    const fitted = fitWindow(camera, inner, bounds, FIT_MARGIN_PX);
    const mm = mmPerPixel(fitted, inner);
    return {
      ...fitted,
      halfHeight: (mm * height) / 2,
      windowX: fitted.windowX + (mm * extra) / 2,
      windowY: fitted.windowY - (mm * extra) / 2,
    };
  }

  /** One step of what moves by itself; true while something does. */
  animate(now: number, elapsed: number): boolean {
    if (this.coasting) {
      const [azimuth, elevation] = this.coasting;
      const keep = Math.exp(-elapsed / COAST_MS);
      const slow = Math.hypot(azimuth, elevation) * keep < 2e-5;
      this.coasting = slow ? null : [azimuth * keep, elevation * keep];
      // The way covered while slowing down, right however long the frame took.
      const run = COAST_MS * (1 - keep);
      this.orbitBy(azimuth * run, elevation * run);
      return true;
    }
    const { moving } = this;
    if (!moving) return false;
    moving.since ??= now;
    const t = Math.min(1, (now - moving.since) / MOVE_MS);
    const eased = t < 0.5 ? 4 * t * t * t : 1 - (-2 * t + 2) ** 3 / 2;
    if (t >= 1) this.moving = null;
    this.change(t >= 1 ? moving.to : blended(moving.from, moving.to, this.framed.centre(), eased));
    return true;
  }
}
