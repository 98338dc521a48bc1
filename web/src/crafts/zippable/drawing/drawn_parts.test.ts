// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { Drawn, Place3 } from './drawn_parts';
import {
  closedNow,
  cutDone,
  handleName,
  handlesOf,
  moved,
  nothingDrawn,
  segmentsJson,
  withCutPoint,
  without,
  withOpening,
  withPoint,
} from './drawn_parts';

const a: Place3 = [1, 0, 0];
const b: Place3 = [0, 1, 0];
const c: Place3 = [-1, 0, 0];
const d: Place3 = [0, -1, 0];
const ring = (): Drawn => [a, b, c, d].reduce((drawn, place) => withPoint(drawn, place), nothingDrawn);

describe('parts drawn by hand', () => {
  it('closes a border on its first point, or when asked to with three points at least', () => {
    expect(ring().begun).toHaveLength(4);
    const closed = withPoint(ring(), a);
    expect(closed.begun).toEqual([]);
    expect(closed.borders).toEqual([{ points: [a, b, c, d], closed: true }]);
    expect(closedNow(ring())).toEqual(closed);
    const two = withPoint(withPoint(nothingDrawn, a), b);
    expect(closedNow(two)).toBe(two);
  });

  it('says what the operation reads, and nothing before anything is whole', () => {
    expect(segmentsJson(ring())).toBeNull();
    const drawn = withOpening(closedNow(ring()), [0, 0, 1]);
    expect(JSON.parse(segmentsJson(drawn) ?? '')).toEqual({ punctures: [[0, 0, 1]], loops: [[a, b, c, d]] });
  });

  it('draws a line from border to border, whose ends go along and go with them', () => {
    let drawn = closedNow(ring());
    for (const place of [a, [0, 0, 1] as Place3, c]) drawn = withPoint(drawn, place);
    expect(drawn.borders[1]).toEqual({ points: [a, [0, 0, 1], c], closed: false });
    expect(JSON.parse(segmentsJson(drawn) ?? '')).toHaveProperty('lines', [[a, [0, 0, 1], c]]);
    expect(handlesOf(drawn).map(handleName)).toEqual([
      'Point 1 of border 1',
      'Point 2 of border 1',
      'Point 3 of border 1',
      'Point 4 of border 1',
      'Point 2 of border 2',
    ]);
    const hold = { kind: 'border', border: 0, point: 0 } as const;
    const there = moved(drawn, hold, [2, 0, 0]);
    expect(there.borders.map(({ points }) => points[0])).toEqual([
      [2, 0, 0],
      [2, 0, 0],
    ]);
    expect(moved(drawn, { kind: 'border', border: 0, point: 1 }, [0, 2, 0]).borders[1]?.points).toBe(
      drawn.borders[1]?.points,
    );
    expect(without(drawn, hold).borders).toEqual([{ points: [b, c, d], closed: true }]);
  });

  it('lets a border go that has too few points left', () => {
    let drawn = closedNow(ring());
    drawn = without(drawn, { kind: 'border', border: 0, point: 3 });
    expect(drawn.borders).toHaveLength(1);
    expect(without(drawn, { kind: 'border', border: 0, point: 0 }).borders).toEqual([]);
    const open = withOpening(withOpening(nothingDrawn, a), b);
    expect(without(open, { kind: 'opening', opening: 0 }).openings).toEqual([b]);
    expect(moved(open, { kind: 'opening', opening: 1 }, c).openings).toEqual([a, c]);
  });

  it('draws a cut point by point, ends it on its last one, and lets it go when a point is left', () => {
    let drawn = withCutPoint(withCutPoint(nothingDrawn, a), b);
    expect(cutDone(withCutPoint(nothingDrawn, a)).cuts).toEqual([]);
    expect(segmentsJson(drawn)).toBeNull();
    expect(handlesOf(drawn).map(handleName)).toEqual(['Point 1 of the new cut', 'Point 2 of the new cut']);
    drawn = withCutPoint(drawn, b);
    expect(drawn).toEqual({ ...nothingDrawn, cuts: [[a, b]] });
    const both = withOpening(drawn, c);
    expect(JSON.parse(segmentsJson(both) ?? '')).toEqual({ punctures: [c, [a, b]] });
    expect(handlesOf(drawn).map(handleName)).toEqual(['Point 1 of cut 1', 'Point 2 of cut 1']);
    expect(moved(drawn, { kind: 'cut', cut: 0, point: 1 }, d).cuts).toEqual([[a, d]]);
    const longer = { ...drawn, cuts: [[a, b, c]] };
    expect(without(longer, { kind: 'cut', cut: 0, point: 1 }).cuts).toEqual([[a, c]]);
    expect(without(drawn, { kind: 'cut', cut: 0, point: 0 }).cuts).toEqual([]);
    expect(moved({ ...nothingDrawn, begunCut: [a, b] }, { kind: 'begun-cut', point: 0 }, d).begunCut).toEqual(
      [d, b],
    );
    expect(without({ ...nothingDrawn, begunCut: [a, b] }, { kind: 'begun-cut', point: 0 }).begunCut).toEqual([
      b,
    ]);
  });
});
