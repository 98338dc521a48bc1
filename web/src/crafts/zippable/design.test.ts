// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import { boundaryEdges, partName, readDesign } from './design';
import { woundDesign } from './ribbon/test_ribbon';

it('reads ribbon, sides and lengths', () => {
  const design = woundDesign(12);
  expect(design.ribbon.positions.length).toBe(3 * 26);
  expect(design.ribbon.flat.length).toBe(2 * 26);
  expect([...new Set(design.ribbon.side)]).toEqual([1, -1]);
  expect(design.along_mm.length).toBe(13);
  expect(design.along_mm[0]).toBe(0);
  expect(design.along_mm[12]).toBeCloseTo(design.zipper_mm, 3);
  for (let i = 1; i < 13; ++i) expect(design.along_mm[i]).toBeCloseTo((i * design.zipper_mm) / 12, 3);
});

it('tells zipper edges from openings', () => {
  const design = woundDesign(12);
  expect(boundaryEdges(design, 'zipper').length / 2).toBe(24);
  // From the end of one side to the end of the other, and back at the start.
  expect([...boundaryEdges(design, 'opening')]).toEqual([12, 13, 25, 0]);
});

it('says what is no design', () => {
  const bytes = new TextEncoder().encode('{"format": "something else"}');
  expect(() => readDesign(bytes)).toThrow(/not a zippable’s design\.json/);
});

it('counts parts as the core does', () => {
  expect(partName(0)).toBe('Part 1');
});
