// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { readable } from './labels';

const label = (xPx: number, yPx: number, text = '1') => ({ at: { xPx, yPx }, text });

describe('labels', () => {
  it('are all shown where each has room', () => {
    expect(readable([label(0, 0), label(40, 0), label(0, 30)])).toEqual([true, true, true]);
  });
  it('give way to those before them', () => {
    expect(readable([label(0, 0), label(10, 5), label(60, 0)])).toEqual([true, false, true]);
  });
  it('that are hidden take no room', () => {
    expect(readable([label(0, 0), label(15, 0), label(28, 0)])).toEqual([true, false, true]);
  });
  it('of marks out of view take no room either', () => {
    expect(readable([{ at: null, text: '1' }, label(0, 0, '')])).toEqual([false, false]);
  });
  it('need more room the longer they are', () => {
    expect(readable([label(0, 0, 'Part 12'), label(60, 0)])).toEqual([true, false]);
  });
});
