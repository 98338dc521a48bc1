// SPDX-License-Identifier: GPL-3.0-or-later
// What the page may ask of the view. The view knows meshes, not jobs or projects: everything here is
// millimetres in the axes of the (scaled) model, and nothing here needs Three.js to be read.

export type Vec3 = readonly [number, number, number];

/** What `prepareShading` found out about a mesh; only this view reads it. */
export interface MeshShading {
  /** Triangles between drawn vertices, and the mesh vertex of each of those; null: the mesh's own. */
  readonly indices: Uint32Array | null;
  readonly source: Uint32Array | null;
  readonly normals: Float32Array;
  /** The outermost of the mesh's vertices. */
  readonly outline: Uint32Array;
  readonly closed: boolean;
  /** Closed, and its triangles look outwards. */
  readonly outward: boolean;
}

/** A triangle mesh. Arrays are read, never changed; pass new arrays (or `updatePositions`) for new shapes. */
export interface MeshData {
  /** x, y, z per vertex, mm. */
  positions: Float32Array | Float64Array;
  /** Three vertex numbers per triangle, counter-clockwise from outside. */
  indices: Uint32Array;
  /** Unit normals per vertex. Left out: computed, with creases kept sharp. */
  normals?: Float32Array;
  /** From `prepareShading`, so that drawing a large mesh does not stop the page. */
  shading?: MeshShading;
  /** sRGB r, g, b per vertex in 0..1; takes the place of the plaster colour. */
  colours?: Float32Array;
  /** u, v per vertex, origin at the lower left, for `texture`. */
  uvs?: Float32Array;
  /** In the place of `uvs`: u, v per corner of each triangle, for pictures that have seams. */
  cornerUvs?: Float32Array;
  texture?: ImageBitmap | HTMLCanvasElement | HTMLImageElement;
  /** Named scalars per vertex for colour maps; NaN means "no value here". */
  attributes?: Readonly<Record<string, Float32Array>>;
}

/** A flat region of a mesh's convex hull; it can stand on it. In the mesh's own axes and units. */
export interface FlatSide {
  /** Unit, outwards. */
  readonly normal: Vec3;
  readonly area: number;
  /** Three points that touch the plate when the normal points straight down. */
  readonly support: readonly Vec3[];
  /** The border, point by point. */
  readonly outline: readonly Vec3[];
}

/** The plate behind a relief: a slab whose front face is perpendicular to the looking direction. */
export interface Plate {
  widthMm: number;
  heightMm: number;
  /** Thickness of the slab behind its front face; 0 draws a single sheet. */
  thicknessMm: number;
  /** Centre of the front face, the one the relief stands on. */
  centreMm: Vec3;
  /** The direction the viewer looks in (out of the front face, into the plate). Left out: the viewpoint's. */
  direction?: Vec3;
  up?: Vec3;
  /** How far the relief stands out from the front face; spoken and written beside the side view. */
  reliefThicknessMm?: number;
  /** A base that is not a flat slab (curved, stairs), or a relief whose mesh holds its plate already
   *  (`false`: draw no slab, keep the size for dimension lines). */
  mesh?: MeshData | false;
}

/** What stands beside a part without being it: the machine's frame, the model below a sheet. Not picked. */
export interface Fixture {
  id: string;
  mesh: MeshData;
  /** The parts it is drawn with. */
  parts: readonly ('original' | 'relief')[];
  /** Drawn only while its part is translucent: it is inside. */
  within?: boolean;
  /** False: the picture is not made larger for it. */
  framed?: boolean;
  /** Throws a shadow on the bench as this plate would. */
  shadow?: Plate;
}

export type Projection = 'perspective' | 'orthographic';

/** Where the maker looks from; the same words as the relief's parameters. */
export interface Viewpoint {
  projection: Projection;
  /** Looking direction, from the eye into the scene. Any length but 0. */
  direction: Vec3;
  /** Up in the picture; need not be perpendicular to `direction`. */
  up: Vec3;
  /** The point looked at, on the plate's front plane. */
  targetMm: Vec3;
  /** Distance of the eye from `targetMm`; the eye is targetMm - distanceMm * direction. Without meaning
   *  (but kept for switching back to perspective) when orthographic. */
  distanceMm: number;
  /** Angle under which the width of the picture is seen. Reported by `getCameraAsViewpoint`; when setting a
   *  viewpoint it is only used where distanceMm is not positive: distance = width / (2 tan(fov / 2)). */
  fieldOfViewDeg: number;
}

/** 'swipe' shows the original left of the divider and the relief right of it, through one camera.
 *  'error' is the relief coloured by the chosen attribute. */
export type ViewMode = 'swipe' | 'relief' | 'original' | 'error';

/** Space taken by floating panels, CSS pixels from each edge of the viewport. */
export interface Insets {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

/** Where the light comes from, in the picture seen from the viewpoint (or in the current picture). */
export interface LightDirection {
  /** Counter-clockwise from the right: 0 from the right, 90 from above, 135 from the upper left. */
  azimuthDeg: number;
  /** 0 grazes the picture plane, 90 comes from the viewer. */
  elevationDeg: number;
  /** 'object' keeps the light beside the object while one orbits; 'camera' carries it along. */
  follows?: 'object' | 'camera';
}

/** 'brightness' shows the values themselves as greys, from black to white: the view's own light does not fall on them. */
export type ColourMapName = 'error' | 'thickness' | 'signed' | 'brightness';

export interface ColourMapping {
  /** Key of MeshData.attributes. */
  attribute: string;
  map: ColourMapName;
  minimum: number;
  maximum: number;
  /** "°", "mm"; written in the legend and the read-out. */
  unit: string;
  /** "Shading difference". */
  label: string;
}

export type Theme = 'light' | 'dark' | 'auto';

/** A straight cut through the scene: everything on the far side of `positionMm` along `axis` is taken away. */
export interface Section {
  /** A model axis or, in 'view', across the picture from left to right; or any direction. */
  axis: 'x' | 'y' | 'z' | 'view' | Vec3;
  /** Signed distance of the plane from the origin along the axis, mm. */
  positionMm: number;
  /** Take away the other side instead. */
  flipped?: boolean;
}

/** A line on or beside the mesh: drawn loops, zipper curves, cut outlines. */
export interface Curve {
  positions: Float32Array | Float64Array;
  closed?: boolean;
  /** Every two positions are a line of their own. */
  separate?: boolean;
  /** CSS colour, or the name of a token ("--live"). */
  colour: string;
  widthPx?: number;
  dashed?: boolean;
  /** Seen through the mesh, faintly. */
  ghost?: boolean;
  /** Mixed with a second colour along an axis: all of it from `toMm` on, none before `fromMm`. */
  blend?: { axis: Vec3; fromMm: number; toMm: number; colour: string };
  /** A value per position that grows along the curve, as time does: what lies beyond `setReach` is all but gone. */
  values?: ArrayLike<number>;
}

/** A dot kept at a place in the scene. `live` is amber: what is hovered, dragged, or the playhead. */
export interface Marker {
  id: string;
  positionMm: Vec3;
  kind: 'live' | 'set';
  label?: string;
}

export interface Hit {
  /** Which mesh was hit. */
  part: 'original' | 'relief' | 'plate';
  positionMm: Vec3;
  /** Outward unit normal of the triangle. */
  normal: Vec3;
  /** Triangle number in MeshData.indices (−1 on a plain plate) and the weights of its corners. */
  triangle: number;
  barycentric: Vec3;
  /** The colour map's attribute at the point, where one is shown and has a value. */
  value: number | null;
  /** Pointer, CSS pixels from the viewport's upper left corner. */
  xPx: number;
  yPx: number;
}

export type ViewPointerEvent = {
  kind: 'move' | 'down' | 'up' | 'click' | 'leave';
  hit: Hit | null;
  /** Pointer, CSS pixels from the viewport's upper left corner, also where nothing is hit; on 'leave' NaN. */
  xPx: number;
  yPx: number;
  /** 0 main, 1 middle, 2 secondary, −1 none. */
  button: number;
  shiftKey: boolean;
  ctrlKey: boolean;
  /** Keep the camera still for this press (drawing a loop, dragging a point). Only on 'down'. With `onLost` a second
   *  finger takes the press away and moves the picture; it is called then, and where the browser ends the press. */
  capture(onLost?: () => void): void;
};

export interface FrameStats {
  /** Time the main thread spent on the frame, ms. */
  cpuMs: number;
  /** Time since the frame before, where they followed each other; else null. */
  intervalMs: number | null;
  triangles: number;
  /** Still pictures are refined over some frames: 0 just begun, 1 finished. */
  refinement: number;
}

export type ViewStatus =
  | { state: 'ready' }
  /** WebGL went away (driver reset, too many tabs); it restores itself where the browser allows. */
  | { state: 'lost'; message: string }
  /** No WebGL 2: nothing can be drawn; the message says what to do. */
  | { state: 'unsupported'; message: string };

export interface ViewportOptions {
  theme?: Theme;
  mode?: ViewMode;
  light?: LightDirection;
  freeRectangle?: Insets;
  /** Upper bound of the device pixel ratio; 2. */
  maximumPixelRatio?: number;
  /** Soft shadow of the object on the ground below it, as in the gallery. For objects without a plate. */
  ground?: boolean;
  /** Dimension lines around the plate; true. */
  dimensions?: boolean;
  /** Refine still pictures with soft shadows and smoother edges; true. */
  refine?: boolean;
  /** Turning keeps the viewpoint's `up` upright, rather than the picture's. */
  uprightTurn?: boolean;
  /** What the two sides of the swipe are called; Original and Relief. */
  partNames?: readonly [original: string, relief: string];
  /** Spoken name of the viewport. */
  label?: string;
  onPointer?(event: ViewPointerEvent): void;
  /** The camera moved, by the maker's hand or by a call; `atViewpoint` while the picture is the viewpoint's. */
  onViewpointChange?(viewpoint: Viewpoint, atViewpoint: boolean): void;
  onSwipe?(position: number): void;
  onStatus?(status: ViewStatus): void;
  onFrame?(stats: FrameStats): void;
}

/** Colour bar contents for one mapping; pure data, the page draws it. */
export interface LegendData {
  label: string;
  unit: string;
  /** CSS gradient from minimum to maximum. */
  gradient: string;
  minimum: number;
  maximum: number;
  ticks: readonly { value: number; fraction: number; text: string }[];
  /** Marked on the bar: the mean, or the thinnest value, where the map has one. */
  mark: { value: number; fraction: number; text: string } | null;
  /** One spoken sentence: range, mean, extremes. */
  summary: string;
}

/** The viewport. Made by `new Viewport(container, options)`; it fills `container` (position: relative). */
export interface ViewportApi {
  readonly status: ViewStatus;
  readonly canvas: HTMLCanvasElement;
  readonly overlay: HTMLDivElement;

  setOriginal(mesh: MeshData | null): void;
  /** A mesh with the same triangles on the same plate is taken as `updateRelief`. */
  setRelief(mesh: MeshData | null, plate: Plate | null): void;
  /** New positions for the same triangles: for live sliders. Normals follow; shading and BVH catch up at rest. */
  updateOriginal(positions: Float32Array | Float64Array): void;
  /** As `updateOriginal`, for positions that only grew or moved: what else is known of the mesh holds. */
  rescaleOriginal(positions: Float32Array | Float64Array): void;
  updateRelief(positions: Float32Array | Float64Array, plate?: Plate | null): void;
  /** New colours for a mesh that was given with colours, without touching the shape. */
  updateColours(part: 'original' | 'relief', colours: Float32Array): void;
  /** New values for an attribute without touching the shape. */
  updateAttribute(part: 'original' | 'relief', name: string, values: Float32Array): void;

  /** Takes the place of all fixtures before. */
  setFixtures(fixtures: readonly Fixture[]): void;
  /** New positions for the same triangles; normals follow only what was `turned`. */
  moveFixture(id: string, positions: Float32Array | Float64Array, turned?: boolean): void;
  /** How much of a part's own mesh hides what is behind it: 1 all, 0 nothing. */
  setOpacity(part: 'original' | 'relief', opacity: number): void;

  setMode(mode: ViewMode): void;
  /** Where the divider stands, 0..1 across the viewport's free rectangle. */
  setSwipe(position: number): void;
  /** What the two sides of the swipe are called from now on. */
  setPartNames(names: readonly [original: string, relief: string]): void;
  setLight(light: LightDirection): void;
  /** Colours for 'error' mode, or (with `always`) for every mode; null is plain plaster. */
  setColourMapping(mapping: ColourMapping | null, always?: boolean): void;
  setErrorRange(minimum: number, maximum: number): void;
  setSection(section: Section | null): void;
  setCurves(curves: readonly Curve[]): void;
  /** How far curves with values are drawn in full; null: to their end. As quick with a million pieces as with one. */
  setReach(value: number | null): void;
  /** How many pieces of curves this machine draws while the picture moves. */
  readonly linePieces: number;
  setMarkers(markers: readonly Marker[]): void;
  setTheme(theme: Theme): void;
  setFreeRectangle(insets: Insets): void;
  setDimensionsVisible(visible: boolean): void;
  setGround(visible: boolean): void;

  /** The place the relief is made for. Neither moves the camera (call lookFromViewpoint) nor calls
   *  onViewpointChange; ask `atViewpoint`. */
  setViewpoint(viewpoint: Viewpoint): void;
  getViewpoint(): Viewpoint;
  /** The current camera as a viewpoint, for "Use this view". */
  getCameraAsViewpoint(): Viewpoint;
  readonly atViewpoint: boolean;
  lookFromViewpoint(animated?: boolean): void;
  /** Fit what is shown into the free rectangle, keeping the direction. */
  fit(animated?: boolean): void;
  orbit(azimuthDeg: number, elevationDeg: number): void;
  zoom(factor: number): void;
  setProjection(projection: Projection): void;

  /** What lies under a point of the viewport (CSS pixels); null while nothing does. */
  pick(xPx: number, yPx: number): Hit | null;
  /** The search tree of a mesh is being built: `pick` and pointers find nothing of it until then. */
  readonly preparingPick: boolean;
  /** Where a point of the scene appears, CSS pixels; null behind the eye. */
  project(positionMm: Vec3): { xPx: number; yPx: number } | null;

  /** The ray of sight through a point of the viewport. */
  rayThrough(xPx: number, yPx: number): { originMm: Vec3; direction: Vec3 };

  /** A small finished picture of one part seen from `look`, PNG; null while there is none to draw. */
  pictureOf(
    part: 'original' | 'relief',
    look: Pick<Viewpoint, 'direction' | 'up'>,
    widthPx: number,
    heightPx: number,
  ): Promise<Blob | null>;
  /** A finished picture of the current view, PNG, without overlays. */
  snapshot(widthPx: number, heightPx: number, options?: { transparent?: boolean }): Promise<Blob>;
  /** While true, a machine without a graphics card draws what changes but refines nothing: its processor is
   *  wanted elsewhere. */
  setResting(resting: boolean): void;
  /** Draw now rather than on the next frame (tests, transitions). */
  renderNow(): void;
  /** Resolves when nothing is left to draw, refine or prepare. */
  settled(): Promise<void>;
  dispose(): void;
}

/** The side view of the relief's thickness. Draws with the viewport's meshes, on its own small canvas. */
export interface SideInsetApi {
  readonly element: HTMLElement;
  dispose(): void;
}

/** The light ball: two sliders (direction, height) behind one ball; spoken "from upper left, 35 degrees high". */
export interface LightBallApi {
  readonly element: HTMLElement;
  setLight(light: LightDirection): void;
  dispose(): void;
}

export interface ThumbnailOptions {
  theme?: 'light' | 'dark';
  /** Looked from here; left out: three quarters from above. */
  viewpoint?: Pick<Viewpoint, 'direction' | 'up'> & Partial<Viewpoint>;
  plate?: Plate | null;
  mapping?: ColourMapping;
  /** Soft shadow on the ground; true without a plate. */
  ground?: boolean;
  transparent?: boolean;
  /** Every sample even without a graphics card: for pictures made once and kept. */
  patient?: boolean;
}
