// SPDX-License-Identifier: GPL-3.0-or-later
// A forest's scene as docs/relief.md describes it, and how a maker changes it: mm, x right and y back, z up. What of it
// makes sense, and what a viewpoint sees, the core says.
import type { Json } from '../../../jobs/contract';

export type Place = readonly [x_mm: number, y_mm: number];
export type Place3 = readonly [x_mm: number, y_mm: number, z_mm: number];

export interface Viewpoint {
  readonly eye_mm: Place3;
  readonly look_at_mm: Place3;
  /** Of the model, where it seems to stand. */
  readonly width_mm: number;
  readonly sample?: string;
  readonly vertices?: number;
  /** The number of a file, from 1. */
  readonly model?: number;
  readonly direction?: Place3;
  readonly up?: Place3;
}

export const shapes = ['round', 'square', 'hexagon'] as const;
export type Shape = (typeof shapes)[number];

export interface ShapedPillar {
  readonly shape: Shape;
  readonly x_mm: number;
  readonly y_mm: number;
  readonly width_mm: number;
  readonly turn_deg?: number;
  readonly height_mm: number;
}
interface OutlinedPillar {
  readonly outline_mm: readonly Place[];
  readonly height_mm: number;
}
export type Pillar = ShapedPillar | OutlinedPillar;

export interface Scene {
  readonly viewpoints: readonly Viewpoint[];
  readonly pillars: readonly Pillar[];
}

/** What is chosen in the plan: a viewpoint or a pillar, from 0. */
export interface Chosen {
  readonly kind: 'viewpoint' | 'pillar';
  readonly index: number;
}

/** Of bytes that the core wrote. */
export const readScene = (bytes: Uint8Array): Scene => JSON.parse(new TextDecoder().decode(bytes)) as Scene;
/** Equal scenes, equal bytes. */
export const sceneBytes = (scene: Scene): Uint8Array<ArrayBuffer> =>
  new TextEncoder().encode(JSON.stringify(scene));
export const sceneJson = (scene: Scene): Json => scene as unknown as Json;

/** Tenths of a millimetre are finer than anybody drags. */
export const rounded = (value: number): number => Math.round(value * 10) / 10;

const replaced = <T>(list: readonly T[], index: number, change: (one: T) => T): T[] =>
  list.map((one, i) => (i === index ? change(one) : one));

// ---- pillars ----

export const isShaped = (pillar: Pillar): pillar is ShapedPillar => 'shape' in pillar;

const range = (values: readonly number[]): readonly [number, number] => [
  Math.min(...values),
  Math.max(...values),
];

/** Its middle: of an outline, of the box around it. */
export function placeOf(pillar: Pillar): Place {
  if (isShaped(pillar)) return [pillar.x_mm, pillar.y_mm];
  const [x, y] = [0, 1].map((k) => range(pillar.outline_mm.map((corner) => corner[k] ?? 0)));
  return [0.5 * ((x?.[0] ?? 0) + (x?.[1] ?? 0)), 0.5 * ((y?.[0] ?? 0) + (y?.[1] ?? 0))];
}

/** Of an outline, from left to right. */
export function widthOf(pillar: Pillar): number {
  if (isShaped(pillar)) return pillar.width_mm;
  const [left, right] = range(pillar.outline_mm.map(([x]) => x));
  return right - left;
}

/** Of a circle about its middle that holds it. */
function reachOf(pillar: Pillar): number {
  if (isShaped(pillar)) return (pillar.shape === 'square' ? Math.SQRT1_2 : 0.5) * pillar.width_mm;
  const [x, y] = placeOf(pillar);
  return Math.max(...pillar.outline_mm.map((corner) => Math.hypot(corner[0] - x, corner[1] - y)));
}

export function movedPillar(pillar: Pillar, [x, y]: Place): Pillar {
  if (isShaped(pillar)) return { ...pillar, x_mm: rounded(x), y_mm: rounded(y) };
  const [fromX, fromY] = placeOf(pillar);
  const [byX, byY] = [rounded(x) - fromX, rounded(y) - fromY];
  return { ...pillar, outline_mm: pillar.outline_mm.map(([a, b]) => [a + byX, b + byY] as const) };
}

/** An outline becomes larger or smaller about its middle; without a width it would have no shape to come back to. */
export function widenedPillar(pillar: Pillar, width_mm: number): Pillar {
  if (!isShaped(pillar) && !(width_mm > 0)) return pillar;
  if (isShaped(pillar)) return { ...pillar, width_mm };
  const [x, y] = placeOf(pillar);
  const by = width_mm / widthOf(pillar);
  return {
    ...pillar,
    outline_mm: pillar.outline_mm.map(([a, b]) => [x + by * (a - x), y + by * (b - y)] as const),
  };
}

/** With a shape that has a name, where it stands. */
export function shapedPillar(pillar: Pillar, shape: Shape): Pillar {
  if (isShaped(pillar)) return { ...pillar, shape };
  const [x, y] = placeOf(pillar);
  return {
    shape,
    x_mm: rounded(x),
    y_mm: rounded(y),
    width_mm: rounded(widthOf(pillar)),
    height_mm: pillar.height_mm,
  };
}

/** Corners of a circle that is changed by hand. */
const roundCorners = 8;

/** With an outline of its own, for now the one that it has. */
export function outlinedPillar(pillar: Pillar): Pillar {
  if (!isShaped(pillar)) return pillar;
  const { shape, x_mm, y_mm, width_mm, turn_deg = 0, height_mm } = pillar;
  const count = { round: roundCorners, square: 4, hexagon: 6 }[shape];
  const radius = (shape === 'square' ? Math.SQRT1_2 : 0.5) * width_mm;
  const first_deg = turn_deg + (shape === 'square' ? 45 : 0);
  const outline_mm = Array.from({ length: count }, (_, k): Place => {
    const angle = ((first_deg + (360 * k) / count) * Math.PI) / 180;
    return [rounded(x_mm + radius * Math.cos(angle)), rounded(y_mm + radius * Math.sin(angle))];
  });
  return { outline_mm, height_mm };
}

export const cornersOf = (pillar: Pillar): readonly Place[] => (isShaped(pillar) ? [] : pillar.outline_mm);

export const movedCorner = (pillar: Pillar, corner: number, [x, y]: Place): Pillar =>
  isShaped(pillar)
    ? pillar
    : { ...pillar, outline_mm: replaced(pillar.outline_mm, corner, () => [rounded(x), rounded(y)]) };

/** In the middle of the side that begins at this corner. */
export function addedCorner(pillar: Pillar, corner: number): Pillar {
  if (isShaped(pillar)) return pillar;
  const { outline_mm } = pillar;
  return { ...pillar, outline_mm: outline_mm.toSpliced(corner + 1, 0, middleOfSide(outline_mm, corner)) };
}

/** A triangle keeps its corners. */
export const removedCorner = (pillar: Pillar, corner: number): Pillar =>
  isShaped(pillar) || pillar.outline_mm.length <= 3
    ? pillar
    : { ...pillar, outline_mm: pillar.outline_mm.toSpliced(corner, 1) };

export function middleOfSide(outline: readonly Place[], corner: number): Place {
  const [a, b] = [outline[corner] ?? [0, 0], outline[(corner + 1) % outline.length] ?? [0, 0]];
  return [rounded(0.5 * (a[0] + b[0])), rounded(0.5 * (a[1] + b[1]))];
}

export const changePillar = (scene: Scene, index: number, change: (pillar: Pillar) => Pillar): Scene => ({
  ...scene,
  pillars: replaced(scene.pillars, index, change),
});

/** Between pillars that are put somewhere; whether their reliefs need more the core says. */
const gap_mm = 5;

/** The nearest place to `wanted`, ring by ring, where a pillar as wide as this one stands free. */
function freePlace(pillars: readonly Pillar[], pillar: Pillar, [x, y]: Place): Place {
  const own = reachOf(pillar);
  const isFree = ([a, b]: Place) =>
    pillars.every((other) => {
      const [c, d] = placeOf(other);
      return Math.hypot(a - c, b - d) >= own + reachOf(other) + gap_mm;
    });
  const step = own + gap_mm;
  for (let ring = 0; ring < 100; ++ring) {
    const directions = Math.max(1, 8 * ring);
    for (let k = 0; k < directions; ++k) {
      const angle = (2 * Math.PI * k) / directions;
      const place: Place = [
        rounded(x + ring * step * Math.cos(angle)),
        rounded(y + ring * step * Math.sin(angle)),
      ];
      if (isFree(place)) return place;
    }
  }
  return [x, y];
}

/** Another one like the given, beside it. Without one: like the last, or the `first`, at the middle of what is looked at. */
export function addPillar(scene: Scene, like: number | null, first: Pillar): Scene {
  const { pillars } = scene;
  const model = (like === null ? pillars.at(-1) : pillars[like]) ?? first;
  const wanted = like === null ? middleOf(scene) : placeOf(model);
  const added = movedPillar(model, freePlace(pillars, model, wanted));
  return { ...scene, pillars: [...pillars, added] };
}

export const removePillar = (scene: Scene, index: number): Scene => ({
  ...scene,
  pillars: scene.pillars.filter((_, i) => i !== index),
});

// ---- viewpoints ----

const mean = (values: readonly number[]) =>
  values.reduce((sum, value) => sum + value, 0) / Math.max(1, values.length);

function middleOf({ viewpoints }: Scene): Place {
  return [
    mean(viewpoints.map(({ look_at_mm }) => look_at_mm[0])),
    mean(viewpoints.map(({ look_at_mm }) => look_at_mm[1])),
  ];
}

export const changeViewpoint = (
  scene: Scene,
  index: number,
  change: (viewpoint: Viewpoint) => Viewpoint,
): Scene => ({ ...scene, viewpoints: replaced(scene.viewpoints, index, change) });

export type End = 'eye_mm' | 'look_at_mm';

/** In the floor plan: the height stays. */
export const movedEnd = (viewpoint: Viewpoint, end: End, [x, y]: Place): Viewpoint => ({
  ...viewpoint,
  [end]: [rounded(x), rounded(y), viewpoint[end][2]],
});

/** The eye goes round what it looks at, as far away as before, to the side where `towards` lies. */
export function turnedTo(viewpoint: Viewpoint, towards: Place): Viewpoint {
  const [x, y] = viewpoint.look_at_mm;
  const angle = Math.atan2(towards[1] - y, towards[0] - x);
  const distance = distanceOf(viewpoint);
  return movedEnd(viewpoint, 'eye_mm', [x + distance * Math.cos(angle), y + distance * Math.sin(angle)]);
}

/** From the eye to what it looks at, in the floor plan. */
export const distanceOf = ({ eye_mm, look_at_mm }: Viewpoint): number =>
  Math.hypot(eye_mm[0] - look_at_mm[0], eye_mm[1] - look_at_mm[1]);

export interface Source {
  readonly sample?: string;
  readonly vertices?: number;
  readonly model?: number;
}

/** Another model in the same place; how the old one was turned says nothing of it. */
export function withSource(viewpoint: Viewpoint, source: Source): Viewpoint {
  const { eye_mm, look_at_mm, width_mm } = viewpoint;
  return { eye_mm, look_at_mm, width_mm, ...source };
}

/** Another one with the same model, on the side where most room is left between the others. */
export function addViewpoint(scene: Scene, like: number | null): Scene {
  const { viewpoints } = scene;
  const model = (like === null ? viewpoints.at(-1) : viewpoints[like]) ?? viewpoints[0];
  if (model === undefined) return scene;
  const [x, y] = model.look_at_mm;
  const angles = viewpoints
    .map(({ eye_mm }) => Math.atan2(eye_mm[1] - y, eye_mm[0] - x))
    .sort((a, b) => a - b);
  let [widest, angle] = [-1, 0];
  angles.forEach((from, i) => {
    const to = angles[i + 1] ?? (angles[0] ?? 0) + 2 * Math.PI;
    if (to - from > widest + 1e-9) [widest, angle] = [to - from, 0.5 * (from + to)];
  });
  const added = turnedTo(model, [x + Math.cos(angle), y + Math.sin(angle)]);
  return { ...scene, viewpoints: [...viewpoints, added] };
}

export const removeViewpoint = (scene: Scene, index: number): Scene => ({
  ...scene,
  viewpoints: scene.viewpoints.filter((_, i) => i !== index),
});
