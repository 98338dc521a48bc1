// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import { ownWindings, withOwnWindings } from './own_windings';

it('sets windings of one part and leaves the others as they are', () => {
  expect(ownWindings('3 0, 2.5')).toEqual([3, 0, 2.5]);
  expect(ownWindings('')).toEqual([]);
  expect(ownWindings(null)).toEqual([]);
  expect(withOwnWindings([], 2, 4)).toBe('0 0 4');
  expect(withOwnWindings([3, 0, 2.5], 0, null)).toBe('0 0 2.5');
  expect(withOwnWindings([3, 0, 2.5], 2, null)).toBe('3');
  expect(withOwnWindings([3], 0, null)).toBe('');
});
