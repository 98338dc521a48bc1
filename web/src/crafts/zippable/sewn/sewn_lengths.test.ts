// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { inOrder, isMeasured, isStrange, lengthsCsv, lengthsIn, problemOf } from './sewn_lengths';

const report = {
  lengths: [
    { from: '12', to: '40', state: 'zipped', expected_mm: 143.5 },
    { from: '3L', to: '7R', state: 'flat', expected_mm: 24.8 },
    { from: 3, to: '7', state: 'zipped', expected_mm: 1 },
    { from: '1', to: '7', state: 'wet', expected_mm: 1 },
  ],
};

describe('lengths of a sewn zippable', () => {
  it('reads what the plan asks for, and passes over what it does not know', () => {
    const lengths = lengthsIn(report);
    expect(lengths.map(({ from, to }) => `${from}-${to}`)).toEqual(['12-40', '3L-7R']);
    expect(lengthsIn({})).toEqual([]);
  });

  it('asks for flat lengths first', () => {
    expect(inOrder(lengthsIn(report)).map(({ state }) => state)).toEqual(['flat', 'zipped']);
  });

  it('writes what was measured, with commas read as decimal points', () => {
    const [zipped, flat] = lengthsIn(report);
    if (!zipped || !flat) throw new Error('two lengths');
    const typed = [
      { ...zipped, measured: '144,5' },
      { ...flat, measured: '' },
    ];
    expect(lengthsCsv(typed)).toBe('from,to,state,length_mm\n12,40,zipped,144.5\n');
    expect(typed.map(isMeasured)).toEqual([true, false]);
  });

  it('says what is no length, and doubts one that is far off', () => {
    const [zipped] = lengthsIn(report);
    if (!zipped) throw new Error('a length');
    expect(problemOf({ ...zipped, measured: 'twelve' })).toMatch(/millimetres/);
    expect(problemOf({ ...zipped, measured: '-3' })).toMatch(/millimetres/);
    expect(problemOf({ ...zipped, measured: '' })).toBeNull();
    expect(isStrange({ ...zipped, measured: '14.4' })).toBe(true);
    expect(isStrange({ ...zipped, measured: '150' })).toBe(false);
  });
});
