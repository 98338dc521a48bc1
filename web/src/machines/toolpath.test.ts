// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { ToolPath } from './toolpath';
import { lastNotAbove, layersOf, placeAt, readToolPath, timeOfLine, workBounds } from './toolpath';

const path = {
  version: 1,
  bed_mm: [100, 80],
  seconds: 4,
  paths: [
    {
      kind: 'travel',
      layer: '',
      part: '',
      pass: 1,
      power_percent: 0,
      speed_mm_per_s: 10,
      points_mm: [0, 0, 0, 10, 0, 0],
      times_s: [0, 1],
      lines: [0, 3],
    },
    {
      kind: 'work',
      layer: 'cut',
      part: 'A1',
      pass: 1,
      power_percent: 80,
      speed_mm_per_s: 10,
      points_mm: [10, 0, 0, 20, 0, 0, 20, 20, 0],
      times_s: [1, 2, 4],
      lines: [3, 4, 6],
    },
  ],
};
const toolPath: ToolPath = readToolPath(JSON.stringify(path));

describe('a tool path', () => {
  it('says where the head is', () => {
    expect(placeAt(toolPath, 0.5)).toMatchObject({ path: 0, x_mm: 5, y_mm: 0 });
    expect(placeAt(toolPath, 1.5)).toMatchObject({ path: 1, point: 0, x_mm: 15 });
    expect(placeAt(toolPath, 3)).toMatchObject({ path: 1, point: 1, x_mm: 20, y_mm: 10 });
    expect(placeAt(toolPath, 99)).toMatchObject({ x_mm: 20, y_mm: 20 });
    expect(placeAt({ ...toolPath, paths: [] }, 1)).toBeNull();
  });
  it('says when a line is done', () => {
    expect(timeOfLine(toolPath, 0)).toBe(0);
    expect(timeOfLine(toolPath, 4)).toBe(2);
    expect(timeOfLine(toolPath, 5)).toBe(2);
    expect(timeOfLine(toolPath, 600)).toBe(4);
  });
  it('counts the lines of every stage from its own beginning', () => {
    const stages = [
      { name: 'rough', file: 'job_1_rough.gcode', first_path: 0, start_s: 0 },
      { name: 'finish', file: 'job_2_finish.gcode', first_path: 1, start_s: 1 },
    ];
    const staged = readToolPath(JSON.stringify({ ...path, stages }));
    expect(timeOfLine(staged, 600)).toBe(1);
    expect(timeOfLine(staged, 0, 1)).toBe(1);
    expect(timeOfLine(staged, 4, 1)).toBe(2);
    expect(timeOfLine(staged, 600, 1)).toBe(4);
  });
  it('knows its bounds and layers, travel left out', () => {
    expect(workBounds(toolPath)).toEqual([10, 0, 20, 20]);
    expect(layersOf(toolPath)).toEqual([
      { layer: 'cut', power_percent: [80, 80], speed_mm_per_s: [10, 10], parts: 1 },
    ]);
    expect(workBounds({ ...toolPath, paths: [] })).toBeNull();
  });
  it('refuses what it does not know', () => {
    expect(() => readToolPath('{"version":2,"paths":[]}')).toThrow(/another version/);
  });
  it('searches ascending numbers', () => {
    expect(lastNotAbove([1, 2, 2, 5], 2)).toBe(2);
    expect(lastNotAbove([1, 2], 0)).toBe(-1);
    expect(lastNotAbove([], 3)).toBe(-1);
  });
});
