// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { readDesign } from '../design';
import { paintedRibbon } from './paint';
import { woundStrip } from './test_ribbon';

const read = (text: string) => readDesign(new TextEncoder().encode(text));

/** A piece for each triangle. */
const whole = (part: Int32Array) => ({ part, of: Uint32Array.from(part.keys()) });

describe('the ribbon’s paint', () => {
  it('is each part’s own colour with one fabric', () => {
    const design = read(woundStrip(4));
    expect(design.fabric).toBeNull();
    const { ofPiece, paints } = paintedRibbon(design, whole(new Int32Array(8)));
    expect([...ofPiece]).toEqual(Array(8).fill(0));
    expect(paints.map(({ part }) => part)).toEqual([0]);
  });

  it('is each fabric’s colour with two, and keeps the parts apart', () => {
    const file = JSON.parse(woundStrip(4)) as { ribbon: { fabric: number[] }; parts: unknown[] };
    file.ribbon.fabric = [0, 0, 0, 0, 1, 1, 1, 1];
    file.parts.push(file.parts[0]);
    const design = read(JSON.stringify(file));
    const { ofPiece, paints } = paintedRibbon(design, whole(Int32Array.from([0, 0, 1, 1, 0, 0, 1, 1])));
    const of = (t: number) => paints[ofPiece[t] ?? -1];
    expect([of(0)?.part, of(2)?.part, of(4)?.part, of(6)?.part]).toEqual([0, 1, 0, 1]);
    expect(of(0)?.token).toBe(of(2)?.token);
    expect(of(4)?.token).toBe(of(6)?.token);
    expect(of(0)?.token).not.toBe(of(4)?.token);
  });
});
