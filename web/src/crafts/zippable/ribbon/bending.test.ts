// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import { Bending } from './bending';
import { woundDesign } from './test_ribbon';

const { ribbon } = woundDesign(20);
const bending = new Bending(ribbon);
const count = ribbon.sample.length;
const distance = (positions: ArrayLike<number>, size: number, a: number, b: number) =>
  Math.hypot(
    ...Array.from(
      { length: size },
      (_, k) => (positions[size * a + k] ?? 0) - (positions[size * b + k] ?? 0),
    ),
  );

it('is the zipped ribbon in the end', () => {
  const end = bending.at(1);
  end.forEach((value, i) => expect(value).toBeCloseTo(ribbon.positions[i] ?? NaN, 3));
});

it('is the flat ribbon at the start, up to where it lies', () => {
  const start = bending.at(0);
  for (let a = 0; a < count; ++a)
    for (let b = 0; b < a; ++b)
      expect(distance(start, 3, a, b)).toBeCloseTo(distance(ribbon.flat, 2, a, b), 3);
});

it('keeps every edge’s length on the way', () => {
  for (const share of [0.1, 0.5, 0.9]) {
    const positions = bending.at(share);
    for (let at = 0; at < ribbon.triangles.length; ++at) {
      const next = at % 3 === 2 ? at - 2 : at + 1;
      const [a = 0, b = 0] = [ribbon.triangles[at], ribbon.triangles[next]];
      expect(distance(positions, 3, a, b)).toBeCloseTo(distance(ribbon.positions, 3, a, b), 3);
    }
  }
});

it('moves: halfway is neither', () => {
  const [half, end] = [bending.at(0.5), bending.at(1)];
  expect(Math.max(...half.map((value, i) => Math.abs(value - (end[i] ?? 0))))).toBeGreaterThan(1);
});
