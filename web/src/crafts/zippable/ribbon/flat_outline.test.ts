// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import { boundaryEdges } from '../design';
import { edgePath, fitFlat, partLabels, partPaths, scaleBar } from './flat_outline';
import { woundDesign } from './test_ribbon';

const design = woundDesign(12);
const { flat } = design.ribbon;

it('fits the ribbon into the pane, as large as it goes, in the same scale both ways', () => {
  for (const [width, height] of [
    [400, 700],
    [900, 300],
  ] as const) {
    const fit = fitFlat(flat, width, height);
    const xs = flat.filter((_, i) => i % 2 === 0).map((x) => fit.x + fit.pxPerMm * x);
    const ys = flat.filter((_, i) => i % 2 === 1).map((y) => fit.y - fit.pxPerMm * y);
    const [left, right] = [Math.min(...xs), Math.max(...xs)];
    const [top, bottom] = [Math.min(...ys), Math.max(...ys)];
    expect(left).toBeGreaterThan(23.9);
    expect(right).toBeLessThan(width - 23.9);
    expect(top).toBeGreaterThan(63.9);
    expect(bottom).toBeLessThan(height - 71.9);
    const slack = Math.min(left - 24, top - 64);
    expect(Math.abs(slack)).toBeLessThan(0.1);
  }
});

it('draws every triangle once, and the zipper as two lines', () => {
  const none = new Int32Array(24);
  const [all, nothing] = partPaths(design.ribbon, none, 2);
  expect(all?.match(/M/g)).toHaveLength(24);
  expect(nothing).toBe('');
  expect(edgePath(flat, boundaryEdges(design, 'zipper')).match(/M/g)).toHaveLength(2);
});

it('writes a part’s number on the part', () => {
  const half = Int32Array.from({ length: 24 }, (_, t) => (t < 12 ? 0 : 2));
  const [first, second, third] = partLabels(design.ribbon, half, 3);
  expect(second).toBeNull();
  expect(first?.[0]).toBeLessThan(third?.[0] ?? -Infinity);
});

it('has a round scale bar', () => {
  expect(scaleBar(2.1)).toEqual({ px: 105, text: '50\u2009mm' });
  expect(scaleBar(0.08)).toEqual({ px: 80, text: '1\u2009m' });
});
