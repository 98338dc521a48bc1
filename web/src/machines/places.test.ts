// SPDX-License-Identifier: GPL-3.0-or-later
import fc from 'fast-check';
import { expect, test } from 'vitest';
import { bedOfWork, workBoundsOfBed, workOfBed } from './places';

const bed = [600, 400] as const;

test('the corner of the bed in the three ways of counting', () => {
  expect(workOfBed([0, 0], 'lower_left', bed)).toEqual([0, 0]);
  expect(workOfBed([0, 0], 'upper_left', bed)).toEqual([0, 400]);
  expect(workOfBed([0, 0], 'centre', bed)).toEqual([-300, -200]);
});

test('there and back is nothing', () => {
  const mm = fc.double({ min: -1000, max: 1000, noNaN: true });
  fc.assert(
    fc.property(mm, mm, fc.constantFrom('lower_left', 'upper_left', 'centre'), (x, y, origin) => {
      const there = bedOfWork(workOfBed([x, y], origin, bed), origin, bed);
      expect(there[0]).toBeCloseTo(x, 6);
      expect(there[1]).toBeCloseTo(y, 6);
    }),
  );
});

test('bounds stay in order where y counts downwards', () => {
  expect(workBoundsOfBed([10, 20, 30, 60], 'upper_left', bed)).toEqual([10, 340, 30, 380]);
  expect(workBoundsOfBed([10, 20, 30, 60], 'centre', bed)).toEqual([-290, -180, -270, -140]);
});
