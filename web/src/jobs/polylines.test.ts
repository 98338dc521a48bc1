// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import { parsePolylines } from './polylines';

const parse = (text: string) => parsePolylines(new TextEncoder().encode(text));

it('reads lines as the core writes them', () => {
  const lines = parse('# course\nv 0 0 1.5\nv 2 0 0\nl 1 2\nv 3 4 5e-1\nl 2 3 1\n');
  expect(lines.map((line) => [...line])).toEqual([
    [0, 0, 1.5, 2, 0, 0],
    [2, 0, 0, 3, 4, 0.5, 0, 0, 1.5],
  ]);
});

it('says which vertex is missing', () => {
  expect(() => parse('v 0 0 0\nl 1 2\n')).toThrow('The curve names vertex 2, which it does not have.');
});
