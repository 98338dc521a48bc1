// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import {
  formatValue,
  legendFor,
  mapTexels,
  parseColour,
  sampleStops,
  statisticsOf,
  stopsOf,
  tickStep,
} from './colour_map';

const token = 'linear-gradient(90deg, #faf6e6, #fbedbe, #4a1a10)';

describe('colour maps', () => {
  it('read their stops from the token, and have their own without one', () => {
    expect(stopsOf('error', token)).toEqual([
      [250, 246, 230],
      [251, 237, 190],
      [74, 26, 16],
    ]);
    expect(stopsOf('error', '')).toHaveLength(9);
    expect(parseColour('rgb(1, 2 , 3)')).toEqual([1, 2, 3]);
    expect(parseColour('#abc')).toEqual([170, 187, 204]);
    expect(parseColour('tomato')).toBeNull();
  });

  it('pass through their stops, blend evenly between and clamp outside', () => {
    const stops = stopsOf('error', token);
    expect(sampleStops(stops, 0.5)).toEqual([251, 237, 190]);
    expect(sampleStops(stops, 0.75)).toEqual([162.5, 131.5, 103]);
    expect(sampleStops(stops, -3)).toEqual(stops[0]);
    expect(sampleStops(stops, 9)).toEqual(stops[2]);
    const texels = mapTexels(stops, 256);
    expect([...texels.subarray(0, 4)]).toEqual([250, 246, 230, 255]);
    expect([...texels.subarray(1020)]).toEqual([74, 26, 16, 255]);
  });

  it('show brightness as it is, whatever the theme', () => {
    expect(sampleStops(stopsOf('brightness', undefined), 0.4)).toEqual([102, 102, 102]);
  });

  it('read in grey: error darkens all the way, the signed map is darkest at both ends', () => {
    const luminance = ([r, g, b]: readonly [number, number, number]): number =>
      0.2126 * r + 0.7152 * g + 0.0722 * b;
    const along = (name: 'error' | 'thickness' | 'signed'): number[] =>
      Array.from({ length: 41 }, (_, i) => luminance(sampleStops(stopsOf(name), i / 40)));
    const error = along('error');
    const thickness = along('thickness');
    for (let i = 1; i < error.length; ++i) {
      expect(error[i]).toBeLessThan(error[i - 1] as number);
      expect(thickness[i]).toBeGreaterThan(thickness[i - 1] as number);
    }
    const signed = along('signed');
    for (let i = 1; i <= 20; ++i) {
      expect(signed[i]).toBeGreaterThan(signed[i - 1] as number);
      expect(signed[20 + i]).toBeLessThan(signed[19 + i] as number);
    }
  });
});

describe('figures', () => {
  it('have a thin space before units, none before degrees, a true minus and two or three digits', () => {
    expect(formatValue(28.64, '°')).toBe('28.6°');
    expect(formatValue(0.314, 'mm')).toBe('0.31\u2009mm');
    expect(formatValue(-1.5, 'mm')).toBe('\u22121.50\u2009mm');
    expect(formatValue(-0.001, 'mm', 0.1)).toBe('0.0\u2009mm');
    expect(formatValue(120, 'mm')).toBe('120\u2009mm');
  });

  it('stand on round steps', () => {
    expect(tickStep(0, 75, 3)).toBe(25);
    expect(tickStep(0.2, 1, 4)).toBeCloseTo(0.2, 12);
    expect(tickStep(5, 5, 3)).toBe(1);
  });
});

describe('legends', () => {
  const mapping = {
    attribute: 'error',
    map: 'error',
    minimum: 0,
    maximum: 75,
    unit: '°',
    label: 'Shading difference',
  } as const;

  it('name unit, extremes and the mean', () => {
    const legend = legendFor(mapping, Float32Array.of(10, 20, NaN, 60));
    expect(legend.ticks.map((t) => t.text)).toEqual(['0°', '25°', '50°', '75°']);
    expect(legend.mark?.text).toBe('mean 30.0°');
    expect(legend.mark?.fraction).toBeCloseTo(0.4, 12);
    expect(legend.summary).toBe(
      'Shading difference: colours from 0° to 75.0°, values from 10.0° to 60.0°, mean 30.0°.',
    );
  });

  it('mark the thinnest place of a thickness', () => {
    const legend = legendFor(
      { ...mapping, map: 'thickness', unit: 'mm', minimum: 0.2, maximum: 1, label: 'Thickness' },
      Float32Array.of(0.9, 0.31),
    );
    expect(legend.mark?.text).toBe('thinnest 0.31\u2009mm');
    expect(legend.ticks[0]?.text).not.toContain('mm');
    expect(legend.ticks.at(-1)?.text).toContain('mm');
  });

  it('say nothing of values that are not there', () => {
    expect(legendFor(mapping, null).mark).toBeNull();
    expect(statisticsOf(Float32Array.of(NaN, NaN))).toBeNull();
    expect(statisticsOf(Float32Array.of(1, 3), [3, 1])?.mean).toBe(1.5);
  });
});
