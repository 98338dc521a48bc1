// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, test } from 'vitest';
import { printFacts } from './gcode_facts';

const bytes = (text: string) => new TextEncoder().encode(text);

test('time and filament as PrusaSlicer writes them', () => {
  const text = `G1 X1\n; filament used [mm] = 1432.17\n; filament used [cm3] = 3.44\n; total filament used [g] = 4.27\n; estimated printing time (normal mode) = 1d 2h 3m 4s\n; estimated first layer printing time (normal mode) = 1m 1s\n`;
  expect(printFacts(bytes(text))).toEqual({ seconds: 93784, filament_g: 4.27, filament_mm: 1432.17 });
});

test('what is not said is not known', () => {
  expect(printFacts(bytes('G28\nG1 X3\n'))).toEqual({ seconds: null, filament_g: null, filament_mm: null });
  expect(printFacts(bytes('; estimated printing time (normal mode) = soon'))).toMatchObject({
    seconds: null,
  });
});
