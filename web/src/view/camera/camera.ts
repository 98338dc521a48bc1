// SPDX-License-Identifier: GPL-3.0-or-later
// The camera: one formula for perspective and orthographic pictures.
//
// With a, b, c the coordinates of a point along right, up and forward, measured from a target on the optical
// axis, and kappa = 1 / (distance of the eye from the target), the point appears on the plane c = 0 at
//     (a, b) / (1 + kappa c).
// kappa = 0 is the orthographic picture: the same formula, no digits lost on the way there. A relief's
// vertex stays on its ray from the eye, so it appears where its original does; `camera.test.ts` holds on to that.
//
// Zooming and panning choose a window on that plane and leave the eye alone: the two halves of a swipe keep
// coinciding. Only orbiting moves the eye.
import type { Insets, Projection, Vec3, Viewpoint } from '../api';
import { along, cross, dot, mix, normalise, rotate, subtract, viewerAxes } from '../vector';

export interface CameraState {
  target: Vec3;
  right: Vec3;
  up: Vec3;
  forward: Vec3;
  /** 1 / distance of the eye from the target, 1/mm; 0 is orthographic. */
  kappa: number;
  /** Centre of the window on the target's plane, mm right and up of the target. */
  windowX: number;
  windowY: number;
  /** Half the window's height, mm; the window fills the free rectangle's height. */
  halfHeight: number;
}

/** The viewport in CSS pixels and the part of it that floating panels leave free. */
export interface Screen {
  width: number;
  height: number;
  free: { left: number; top: number; width: number; height: number };
}

export interface Bounds2 {
  minX: number;
  minY: number;
  maxX: number;
  maxY: number;
}

/** A free rectangle is never smaller than this share of the viewport, however large the panels. */
const LEAST_FREE = 0.2;

export function makeScreen(width: number, height: number, insets: Insets): Screen {
  const span = (size: number, before: number, after: number): [number, number] => {
    const free = size - before - after;
    if (free >= size * LEAST_FREE) return [before, free];
    const least = size * LEAST_FREE;
    const start = Math.min(Math.max(before + (free - least) / 2, 0), size - least);
    return [start, least];
  };
  const [left, freeWidth] = span(width, insets.left, insets.right);
  const [top, freeHeight] = span(height, insets.top, insets.bottom);
  return { width, height, free: { left, top, width: freeWidth, height: freeHeight } };
}

export function cameraFromViewpoint(viewpoint: Viewpoint, halfHeight: number): CameraState {
  const axes = viewerAxes(viewpoint.direction, viewpoint.up);
  return {
    ...axes,
    target: viewpoint.targetMm,
    kappa: viewpoint.projection === 'perspective' && viewpoint.distanceMm > 0 ? 1 / viewpoint.distanceMm : 0,
    windowX: 0,
    windowY: 0,
    halfHeight,
  };
}

/** The viewpoint whose plate would pass through `through`: the same eye and axes, measured from there. */
export function viewpointFromCamera(
  camera: CameraState,
  screen: Screen,
  through: Vec3,
  orthographicDistance: number,
): Viewpoint {
  const projection: Projection = camera.kappa > 0 ? 'perspective' : 'orthographic';
  const depth = dot(subtract(through, camera.target), camera.forward);
  const width = (2 * camera.halfHeight * screen.free.width) / screen.free.height;
  let targetMm: Vec3;
  let distanceMm: number;
  if (projection === 'perspective') {
    // Perpendicular from the eye: the picture plane stays where it is, whatever was panned.
    targetMm = along(camera.target, camera.forward, depth);
    distanceMm = 1 / camera.kappa + depth;
  } else {
    targetMm = through;
    distanceMm = orthographicDistance;
  }
  return {
    projection,
    direction: camera.forward,
    up: camera.up,
    targetMm,
    distanceMm,
    fieldOfViewDeg: (2 * Math.atan((0.5 * width * (1 + camera.kappa * depth)) / distanceMm) * 180) / Math.PI,
  };
}

/** Coordinates along right, up, forward from the target. */
export function viewCoordinates(camera: CameraState, p: Vec3): Vec3 {
  const d = subtract(p, camera.target);
  return [dot(d, camera.right), dot(d, camera.up), dot(d, camera.forward)];
}

export function mmPerPixel(camera: CameraState, screen: Screen): number {
  return (2 * camera.halfHeight) / screen.free.height;
}

/** CSS pixels from the upper left corner, or null at and behind the eye. */
export function projectToPixels(
  camera: CameraState,
  screen: Screen,
  p: Vec3,
): { xPx: number; yPx: number } | null {
  const [a, b, c] = viewCoordinates(camera, p);
  const w = 1 + camera.kappa * c;
  if (!(w > 1e-9)) return null;
  const mm = mmPerPixel(camera, screen);
  return {
    xPx: screen.free.left + screen.free.width / 2 + (a / w - camera.windowX) / mm,
    yPx: screen.free.top + screen.free.height / 2 - (b / w - camera.windowY) / mm,
  };
}

/** Point on the target's plane under a pixel, mm right and up of the target. */
export function planePoint(camera: CameraState, screen: Screen, xPx: number, yPx: number): [number, number] {
  const mm = mmPerPixel(camera, screen);
  return [
    camera.windowX + (xPx - screen.free.left - screen.free.width / 2) * mm,
    camera.windowY - (yPx - screen.free.top - screen.free.height / 2) * mm,
  ];
}

/** The ray of sight through a pixel. Starts at the eye, or `back` mm before the target's plane when far. */
export function rayThroughPixel(
  camera: CameraState,
  screen: Screen,
  xPx: number,
  yPx: number,
  back: number,
): { origin: Vec3; direction: Vec3 } {
  const [x, y] = planePoint(camera, screen, xPx, yPx);
  const onPlane = along(along(camera.target, camera.right, x), camera.up, y);
  // Direction of increasing c on the ray (a, b) = (x, y)(1 + kappa c).
  const direction = normalise(
    along(along(camera.forward, camera.right, camera.kappa * x), camera.up, camera.kappa * y),
  );
  const reach =
    camera.kappa > 0
      ? Math.min(back, (1 / camera.kappa) * Math.hypot(1, camera.kappa * x, camera.kappa * y))
      : back;
  return { origin: along(onPlane, direction, -reach), direction };
}

/** Column-major clip matrix for points measured from `origin`, covering depths `near` to `far` (mm beyond
 *  the target's plane). x and y map the whole viewport to [-1, 1]. */
export function clipMatrix(
  camera: CameraState,
  screen: Screen,
  origin: Vec3,
  near: number,
  far: number,
): number[] {
  const mm = mmPerPixel(camera, screen);
  const halfX = (screen.width / 2) * mm;
  const halfY = (screen.height / 2) * mm;
  // Centre of the whole viewport on the target's plane.
  const [centreX, centreY] = planePoint(camera, screen, screen.width / 2, screen.height / 2);
  const k = camera.kappa;
  const nearest = k > 0 ? Math.max(near, -0.98 / k) : near;
  const furthest = Math.max(far, nearest + 1e-6);
  // z/w = -1 at `nearest`, 1 at `furthest`, with w = 1 + k c and z = z0 + z1 c.
  const z1 = (2 + k * (nearest + furthest)) / (furthest - nearest);
  const z0 = -1 - k * nearest - z1 * nearest;
  const o = viewCoordinates(camera, origin);
  const { right: r, up: u, forward: f } = camera;
  const w0 = 1 + k * o[2];
  const column = (i: 0 | 1 | 2): number[] => [
    (r[i] - centreX * k * f[i]) / halfX,
    (u[i] - centreY * k * f[i]) / halfY,
    z1 * f[i],
    k * f[i],
  ];
  return [
    ...column(0),
    ...column(1),
    ...column(2),
    (o[0] - centreX * w0) / halfX,
    (o[1] - centreY * w0) / halfY,
    z0 + z1 * o[2],
    w0,
  ];
}

/** Extent on the target's plane of x, y, z triples measured from `origin`; null where nothing lies before the eye. */
export function projectedBounds(
  camera: CameraState,
  points: ArrayLike<number>,
  origin: Vec3,
): Bounds2 | null {
  const { right: r, up: u, forward: f, kappa } = camera;
  const [oa, ob, oc] = viewCoordinates(camera, origin);
  const bounds = { minX: Infinity, minY: Infinity, maxX: -Infinity, maxY: -Infinity };
  for (let i = 0; i + 2 < points.length; i += 3) {
    const x = points[i] as number;
    const y = points[i + 1] as number;
    const z = points[i + 2] as number;
    const w = 1 + kappa * (oc + x * f[0] + y * f[1] + z * f[2]);
    if (!(w > 1e-3)) continue;
    const a = (oa + x * r[0] + y * r[1] + z * r[2]) / w;
    const b = (ob + x * u[0] + y * u[1] + z * u[2]) / w;
    if (a < bounds.minX) bounds.minX = a;
    if (a > bounds.maxX) bounds.maxX = a;
    if (b < bounds.minY) bounds.minY = b;
    if (b > bounds.maxY) bounds.maxY = b;
  }
  return bounds.maxX >= bounds.minX ? bounds : null;
}

export function uniteBounds(a: Bounds2 | null, b: Bounds2 | null): Bounds2 | null {
  if (!a || !b) return a ?? b;
  return {
    minX: Math.min(a.minX, b.minX),
    minY: Math.min(a.minY, b.minY),
    maxX: Math.max(a.maxX, b.maxX),
    maxY: Math.max(a.maxY, b.maxY),
  };
}

/** Chooses the window so that `bounds` fill the free rectangle less `marginPx` on every side. The eye stays. */
export function fitWindow(
  camera: CameraState,
  screen: Screen,
  bounds: Bounds2,
  marginPx: number,
): CameraState {
  const { width, height } = screen.free;
  const margin = Math.min(marginPx, 0.2 * width, 0.2 * height);
  const mm = Math.max(
    (bounds.maxX - bounds.minX) / (width - 2 * margin),
    (bounds.maxY - bounds.minY) / (height - 2 * margin),
    1e-9,
  );
  return {
    ...camera,
    windowX: (bounds.minX + bounds.maxX) / 2,
    windowY: (bounds.minY + bounds.maxY) / 2,
    halfHeight: (mm * height) / 2,
  };
}

/** Moves the picture by pixels. The eye stays. */
export function panned(camera: CameraState, screen: Screen, dxPx: number, dyPx: number): CameraState {
  const mm = mmPerPixel(camera, screen);
  return { ...camera, windowX: camera.windowX - dxPx * mm, windowY: camera.windowY + dyPx * mm };
}

/** Enlarges by `factor` about a pixel, which keeps its place. The eye stays. */
export function zoomed(
  camera: CameraState,
  screen: Screen,
  factor: number,
  xPx: number,
  yPx: number,
): CameraState {
  const [x, y] = planePoint(camera, screen, xPx, yPx);
  return {
    ...camera,
    windowX: x + (camera.windowX - x) / factor,
    windowY: y + (camera.windowY - y) / factor,
    halfHeight: camera.halfHeight / factor,
  };
}

/** Steepest view from above or below, radians. */
const STEEPEST = (88 * Math.PI) / 180;

/** Carries the camera rigidly about `pivot`, which keeps its pixel: `azimuth` about the turntable's axis,
 *  `elevation` about the picture's horizontal, radians. */
export function orbited(
  camera: CameraState,
  turntable: Vec3,
  pivot: Vec3,
  azimuth: number,
  elevation: number,
): CameraState {
  const now = Math.asin(Math.min(1, Math.max(-1, -dot(camera.forward, turntable))));
  const next = Math.min(STEEPEST, Math.max(-STEEPEST, now + elevation));
  const turn = (v: Vec3): Vec3 => rotate(rotate(v, camera.right, now - next), turntable, azimuth);
  const forward = normalise(turn(camera.forward));
  const right = normalise(cross(forward, turn(camera.up)));
  const fromPivot = turn(subtract(camera.target, pivot));
  return { ...camera, forward, right, up: cross(right, forward), target: along(pivot, fromPivot, 1) };
}

/** The same picture, measured from the plane through `through`; for comparing and blending cameras. */
export function remeasured(camera: CameraState, through: Vec3): CameraState {
  const depth = dot(subtract(through, camera.target), camera.forward);
  const w = 1 + camera.kappa * depth;
  if (!(w > 1e-3)) return camera;
  return {
    ...camera,
    target: along(camera.target, camera.forward, depth),
    kappa: camera.kappa / w,
    windowX: camera.windowX * w,
    windowY: camera.windowY * w,
    halfHeight: camera.halfHeight * w,
  };
}

type Quaternion = readonly [number, number, number, number];

function quaternionOf({ right: r, up: u, forward: f }: CameraState): Quaternion {
  // Rotation whose columns are right, up, -forward (Shepperd's method).
  const m = [r[0], u[0], -f[0], r[1], u[1], -f[1], r[2], u[2], -f[2]] as const;
  const w = Math.sqrt(Math.max(0, 1 + m[0] + m[4] + m[8])) / 2;
  const x = Math.sqrt(Math.max(0, 1 + m[0] - m[4] - m[8])) / 2;
  const y = Math.sqrt(Math.max(0, 1 - m[0] + m[4] - m[8])) / 2;
  const z = Math.sqrt(Math.max(0, 1 - m[0] - m[4] + m[8])) / 2;
  const largest = Math.max(w, x, y, z);
  if (largest === w) return [(m[7] - m[5]) / (4 * w), (m[2] - m[6]) / (4 * w), (m[3] - m[1]) / (4 * w), w];
  if (largest === x) return [x, (m[1] + m[3]) / (4 * x), (m[2] + m[6]) / (4 * x), (m[7] - m[5]) / (4 * x)];
  if (largest === y) return [(m[1] + m[3]) / (4 * y), y, (m[5] + m[7]) / (4 * y), (m[2] - m[6]) / (4 * y)];
  return [(m[2] + m[6]) / (4 * z), (m[5] + m[7]) / (4 * z), z, (m[3] - m[1]) / (4 * z)];
}

/** Between two cameras, 0 <= t <= 1: the axes along the shortest turn, the rest evenly, about `centre`. */
export function blended(from: CameraState, to: CameraState, centre: Vec3, t: number): CameraState {
  if (t >= 1) return to;
  const a = remeasured(from, centre);
  const b = remeasured(to, centre);
  const qa = quaternionOf(a);
  let qb = quaternionOf(b);
  let cosine = qa[0] * qb[0] + qa[1] * qb[1] + qa[2] * qb[2] + qa[3] * qb[3];
  if (cosine < 0) {
    qb = [-qb[0], -qb[1], -qb[2], -qb[3]];
    cosine = -cosine;
  }
  const angle = Math.acos(Math.min(1, cosine));
  const wa = angle < 1e-6 ? 1 - t : Math.sin((1 - t) * angle) / Math.sin(angle);
  const wb = angle < 1e-6 ? t : Math.sin(t * angle) / Math.sin(angle);
  const [x, y, z, w] = [0, 1, 2, 3].map((i) => wa * (qa[i] as number) + wb * (qb[i] as number)) as [
    number,
    number,
    number,
    number,
  ];
  const lerp = (p: number, q: number): number => p + (q - p) * t;
  return {
    right: normalise([1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)]),
    up: normalise([2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)]),
    forward: normalise([-2 * (x * z + y * w), -2 * (y * z - x * w), -(1 - 2 * (x * x + y * y))]),
    target: mix(a.target, b.target, t),
    kappa: lerp(a.kappa, b.kappa),
    windowX: lerp(a.windowX, b.windowX),
    windowY: lerp(a.windowY, b.windowY),
    halfHeight: Math.exp(lerp(Math.log(a.halfHeight), Math.log(b.halfHeight))),
  };
}

/** Whether two cameras share eye and axes, so that the same points coincide on screen. */
export function sameEye(a: CameraState, b: CameraState, size: number): boolean {
  if (dot(a.forward, b.forward) < 1 - 1e-9 || dot(a.up, b.up) < 1 - 1e-9) return false;
  const m = remeasured(a, b.target);
  if (Math.abs(m.kappa - b.kappa) * size > 1e-6) return false;
  if (b.kappa === 0) return true;
  const d = subtract(m.target, b.target);
  return Math.hypot(dot(d, b.right), dot(d, b.up)) < 1e-6 * size;
}
