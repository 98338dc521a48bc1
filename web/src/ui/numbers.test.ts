// SPDX-License-Identifier: GPL-3.0-or-later
import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import {
  formatDuration,
  formatNumber,
  formatOnStep,
  niceStep,
  parseNumber,
  roundTo,
  withUnit,
} from './numbers';

describe('numbers', () => {
  it('reads what it wrote', () => {
    fc.assert(
      fc.property(fc.double({ min: -1e6, max: 1e6, noNaN: true }), (value) => {
        const read = parseNumber(formatNumber(value, 6)) ?? NaN;
        expect(Math.abs(read - value)).toBeLessThanOrEqual(Math.max(1e-5 * Math.abs(value), 1e-8));
      }),
    );
  });
  it.each([
    ['5', 5],
    ['5,25', 5.25],
    [' −3.5 ', -3.5],
    ['1 200', 1200],
    ['1e3', 1000],
    ['5 mm', null],
    ['', null],
    ['.', null],
    ['1.2.3', null],
  ])('reads %j as %s', (text, value) => expect(parseNumber(text)).toBe(value));
  it('writes a true minus and a thin space', () => {
    expect(withUnit(formatNumber(-3.14159), 'mm')).toBe('−3.14\u2009mm');
    expect(withUnit('20', '°')).toBe('20°');
  });
  it('divides a slider into 150 round steps or somewhat more', () => {
    fc.assert(
      fc.property(fc.double({ min: 1e-3, max: 1e5, noNaN: true }), (width) => {
        const steps = width / niceStep(0, width);
        expect(steps).toBeGreaterThanOrEqual(149.999);
        expect(steps).toBeLessThanOrEqual(750.001);
      }),
    );
  });
  it('shows the decimals of the step, and more where the value has them', () => {
    expect(formatOnStep(5, 0.1)).toBe('5.0');
    expect(formatOnStep(5.25, 0.1)).toBe('5.25');
    expect(formatOnStep(120, 1)).toBe('120');
    expect(roundTo(0.30000000000000004, 0.1)).toBe(0.3);
    expect(roundTo(7.3, 5)).toBe(5);
  });
  it('says durations with two digits', () => {
    expect([0.01, 0.42, 7.84, 25.3, 240, 7200, 15_300].map(formatDuration)).toEqual([
      'under 0.1\u2009s',
      '0.4\u2009s',
      '7.8\u2009s',
      '25\u2009s',
      '4\u2009min',
      '2\u2009h',
      '4\u2009h 15\u2009min',
    ]);
  });
});
