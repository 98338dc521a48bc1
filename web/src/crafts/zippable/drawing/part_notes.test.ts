// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import { partWarning, unwrapWords } from './part_notes';

const fine = { area_mm2: 1, mean: 1.2, most: 9 };
const note =
  'Part 1 got 0.75 windings instead of 0.65, the smallest number that makes a ribbon; it is narrower there.';

it('repeats what the core says of the part, not of another whose number begins alike', () => {
  expect(partWarning(0, [note], fine)).toBe(
    'Got 0.75 windings instead of 0.65, the smallest number that makes a ribbon; it is narrower there.',
  );
  expect(partWarning(9, [note], fine)).toBeNull();
  expect(partWarning(0, [note.replace('Part 1', 'Part 10')], fine)).toBeNull();
});

it('says where the map is poor', () => {
  expect(partWarning(0, [], fine)).toBeNull();
  expect(partWarning(0, [], { ...fine, mean: 4.3 })).toMatch(/Badly distorted/);
});

it('calls a part well unwrapped only where its distortion is usual', () => {
  expect(unwrapWords(fine)).toBe('Unwraps well.');
  expect(unwrapWords({ ...fine, mean: 2.6 })).toBe('Unwraps unevenly.');
});
