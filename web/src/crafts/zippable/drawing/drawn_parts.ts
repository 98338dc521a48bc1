// SPDX-License-Identifier: GPL-3.0-or-later
// Parts as a maker draws them: borders through a few points each, and openings: holes, or cuts along a path. All in the model file's coordinates.

export type Place3 = readonly [x: number, y: number, z: number];

interface Border {
  readonly points: readonly Place3[];
  /** Else it goes from one border to another. */
  readonly closed: boolean;
}

export interface Drawn {
  readonly borders: readonly Border[];
  readonly openings: readonly Place3[];
  /** Openings that are cuts, each through two points or more. */
  readonly cuts: readonly (readonly Place3[])[];
  /** A border that has not come round yet. */
  readonly begun: readonly Place3[];
  /** A cut that has not come to its end yet. */
  readonly begunCut: readonly Place3[];
}

export const nothingDrawn: Drawn = { borders: [], openings: [], cuts: [], begun: [], begunCut: [] };

/** A point that can be taken hold of. */
export type Handle =
  | { readonly kind: 'border'; readonly border: number; readonly point: number }
  | { readonly kind: 'opening'; readonly opening: number }
  | { readonly kind: 'cut'; readonly cut: number; readonly point: number }
  | { readonly kind: 'begun'; readonly point: number }
  | { readonly kind: 'begun-cut'; readonly point: number };

export const fewestToClose = 3;
export const fewestToCut = 2;

const same = (a: Place3, b: Place3) => a.every((x, k) => x === b[k]);

export function placeOf(
  { borders, openings, cuts, begun, begunCut }: Drawn,
  handle: Handle,
): Place3 | undefined {
  if (handle.kind === 'cut') return cuts[handle.cut]?.[handle.point];
  if (handle.kind === 'begun-cut') return begunCut[handle.point];
  if (handle.kind === 'opening') return openings[handle.opening];
  if (handle.kind === 'begun') return begun[handle.point];
  return borders[handle.border]?.points[handle.point];
}

/** Every point once: where a border begins or ends on another, the other has it. */
export function handlesOf(drawn: Drawn): Handle[] {
  const handles: Handle[] = [];
  const add = (handle: Handle) => {
    const place = placeOf(drawn, handle);
    if (place && !handles.some((other) => same(placeOf(drawn, other) ?? [NaN, 0, 0], place)))
      handles.push(handle);
  };
  drawn.borders.forEach(({ points }, border) =>
    points.forEach((_, point) => add({ kind: 'border', border, point })),
  );
  drawn.openings.forEach((_, opening) => add({ kind: 'opening', opening }));
  drawn.cuts.forEach((points, cut) => points.forEach((_, point) => add({ kind: 'cut', cut, point })));
  drawn.begun.forEach((_, point) => add({ kind: 'begun', point }));
  drawn.begunCut.forEach((_, point) => add({ kind: 'begun-cut', point }));
  return handles;
}

export function handleName(handle: Handle): string {
  if (handle.kind === 'opening') return `Opening ${handle.opening + 1}`;
  if (handle.kind === 'begun') return `Point ${handle.point + 1} of the new border`;
  if (handle.kind === 'begun-cut') return `Point ${handle.point + 1} of the new cut`;
  if (handle.kind === 'cut') return `Point ${handle.point + 1} of cut ${handle.cut + 1}`;
  return `Point ${handle.point + 1} of border ${handle.border + 1}`;
}

/** Borders that meet there go along. */
export function moved(drawn: Drawn, handle: Handle, to: Place3): Drawn {
  const from = placeOf(drawn, handle);
  if (from === undefined) return drawn;
  if (handle.kind === 'opening')
    return { ...drawn, openings: drawn.openings.map((at, i) => (i === handle.opening ? to : at)) };
  const withOne = (list: readonly Place3[], point: number) => list.map((at, i) => (i === point ? to : at));
  if (handle.kind === 'cut')
    return {
      ...drawn,
      cuts: drawn.cuts.map((cut, i) => (i === handle.cut ? withOne(cut, handle.point) : cut)),
    };
  if (handle.kind === 'begun-cut') return { ...drawn, begunCut: withOne(drawn.begunCut, handle.point) };
  // Lists that have no part in it stay the same ones: their ways over the model need not be sought again.
  const points = (list: readonly Place3[]) =>
    list.some((at) => same(at, from)) ? list.map((at) => (same(at, from) ? to : at)) : list;
  const borders = drawn.borders.map((border) => ({ ...border, points: points(border.points) }));
  return { ...drawn, borders, begun: points(drawn.begun) };
}

/** A border of too few points goes altogether, and what hung on a point goes with it. */
export function without(drawn: Drawn, handle: Handle): Drawn {
  const gone = placeOf(drawn, handle);
  if (gone === undefined) return drawn;
  if (handle.kind === 'opening')
    return { ...drawn, openings: drawn.openings.filter((_, i) => i !== handle.opening) };
  if (handle.kind === 'begun-cut')
    return { ...drawn, begunCut: drawn.begunCut.filter((_, i) => i !== handle.point) };
  if (handle.kind === 'cut') {
    const cuts = drawn.cuts.map((cut, i) =>
      i === handle.cut ? cut.filter((_, point) => point !== handle.point) : cut,
    );
    return { ...drawn, cuts: cuts.filter((cut) => cut.length >= fewestToCut) };
  }
  const rest = (points: readonly Place3[]) => points.filter((at) => !same(at, gone));
  const borders = drawn.borders.flatMap(({ points, closed }) => {
    const left = { points: rest(points), closed };
    const hung = !closed && [points[0], points.at(-1)].some((end) => end && same(end, gone));
    return hung || left.points.length < (closed ? fewestToClose : 2) ? [] : [left];
  });
  return { ...drawn, borders, begun: rest(drawn.begun) };
}

export const withOpening = (drawn: Drawn, at: Place3): Drawn => ({
  ...drawn,
  openings: [...drawn.openings, at],
});

/** One point more of a cut; on its own last point it ends. */
export function withCutPoint(drawn: Drawn, at: Place3): Drawn {
  const last = drawn.begunCut.at(-1);
  if (last && same(last, at)) return cutDone(drawn);
  return { ...drawn, begunCut: [...drawn.begunCut, at] };
}

export function cutDone(drawn: Drawn): Drawn {
  if (drawn.begunCut.length < fewestToCut) return drawn;
  return { ...drawn, cuts: [...drawn.cuts, drawn.begunCut], begunCut: [] };
}

/** One point more. Begun and ended on other borders it is whole; on its own first point it closes. */
export function withPoint(drawn: Drawn, at: Place3): Drawn {
  const begun = [...drawn.begun, at];
  const [first] = drawn.begun;
  if (first && same(first, at)) return closedNow(drawn);
  const onBorder = (place: Place3) =>
    drawn.borders.some(({ points }) => points.some((point) => same(point, place)));
  if (first && onBorder(first) && onBorder(at))
    return { ...drawn, borders: [...drawn.borders, { points: begun, closed: false }], begun: [] };
  return { ...drawn, begun };
}

export function closedNow(drawn: Drawn): Drawn {
  if (drawn.begun.length < fewestToClose) return drawn;
  return { ...drawn, borders: [...drawn.borders, { points: drawn.begun, closed: true }], begun: [] };
}

/** A closed border that came at once, beside one that has been begun. */
export const withBorder = (drawn: Drawn, points: readonly Place3[]): Drawn => ({
  ...drawn,
  borders: [...drawn.borders, { points, closed: true }],
});

/** segments.json; null where it would say nothing. */
export function segmentsJson({ borders, openings, cuts }: Drawn): string | null {
  if (borders.length + openings.length + cuts.length === 0) return null;
  const points = (closed: boolean) =>
    borders.filter((border) => border.closed === closed).map((border) => border.points);
  const all = { punctures: [...openings, ...cuts], loops: points(true), lines: points(false) };
  return JSON.stringify(Object.fromEntries(Object.entries(all).filter(([, list]) => list.length > 0)));
}
