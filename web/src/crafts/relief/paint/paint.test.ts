// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { newDocument } from '../../../project/document';
import { subjectOf } from '../../../shared/session/craft_document';
import { relief } from '../relief_document';
import type { PaintKind } from './painted_values';
import {
  counts,
  isPainted,
  kindAt,
  paintedOf,
  paintedOfAttributes,
  paintingJson,
  paintOn,
  unpainted,
  without,
} from './painted_values';
import { paintingInputs, paintingOf, setPainting } from './painting';
import { SurfaceBrush } from './surface_brush';

const paint = (kind: PaintKind | null) => ({ kind, factor: 4, thickness_mm: 2.5 });

describe('what is painted', () => {
  it('keeps a weight and a region of each vertex; the eraser takes both', () => {
    const painted = unpainted(6);
    expect(isPainted(painted)).toBe(false);
    paintOn(painted, [0, 1, 2], paint('more'));
    paintOn(painted, [2, 3], paint('less'));
    paintOn(painted, [1, 4], paint('on_base'));
    expect([...painted.weight]).toEqual([4, 4, 0.25, 0.25, 1, 1]);
    expect([0, 1, 2, 3, 4, 5].map((v) => kindAt(painted, v))).toEqual([
      'more',
      'on_base',
      'less',
      'less',
      'on_base',
      null,
    ]);
    expect(counts(painted)).toEqual({ more: 2, less: 2, free: 0, on_base: 2, own_thickness: 0 });
    paintOn(painted, [1], paint(null));
    expect(kindAt(painted, 1)).toBeNull();
    paintOn(painted, [4], paint('free'));
    expect(kindAt(painted, 4)).toBe('free');
    const less = without(painted, 'less');
    expect([...less.weight]).toEqual([4, 1, 1, 1, 1, 1]);
    expect([...painted.weight]).toEqual([4, 1, 0.25, 0.25, 1, 1]);
  });

  it('is written as runs of equal vertices, and read again', () => {
    const painted = unpainted(8);
    paintOn(painted, [1, 2, 3, 5], paint('own_thickness'));
    paintOn(painted, [0, 7], paint('more'));
    const text = paintingJson(painted);
    expect(JSON.parse(text)).toEqual({
      vertices: 8,
      weight: [
        [0, 1, 4],
        [7, 1, 4],
      ],
      region: [
        [1, 3, 'own_thickness'],
        [5, 1, 'own_thickness'],
      ],
      thickness_mm: [
        [1, 3, 2.5],
        [5, 1, 2.5],
      ],
    });
    expect(paintedOf(text, 8)).toEqual(painted);
    expect(JSON.parse(paintingJson(unpainted(3)))).toEqual({ vertices: 3 });
  });

  it('is nothing of another model, and no text of another kind', () => {
    const text = paintingJson(unpainted(8));
    expect(paintedOf(text, 9)).toBeNull();
    expect(paintedOf('{', 9)).toBeNull();
    expect(paintedOf('null', 9)).toBeNull();
  });

  it('may come with the model', () => {
    const of = (values: number[]) => Float32Array.from(values);
    expect(paintedOfAttributes({ quality: of([1]) }, 1)).toBeNull();
    const painted = paintedOfAttributes({ weight: of([3, 1]), region: of([0, 2]) }, 2);
    expect(painted && [0, 1].map((v) => kindAt(painted, v))).toEqual(['more', 'on_base']);
    const carved = paintedOfAttributes({ carve_depth_mm: of([1, 2]) }, 2);
    expect(carved && JSON.parse(paintingJson(carved))).toEqual({
      vertices: 2,
      region: [[0, 2, 'own_thickness']],
      carve_depth_mm: [
        [0, 1, 1],
        [1, 1, 2],
      ],
    });
  });
});

/** Two squares of n x n cells, one at z = 0 and one close above it, which do not touch. */
function sheets(n: number): SurfaceBrush {
  const positions: number[] = [];
  const indices: number[] = [];
  for (const z of [0, 0.1]) for (let y = 0; y <= n; ++y) for (let x = 0; x <= n; ++x) positions.push(x, y, z);
  for (const sheet of [0, 1])
    for (let y = 0; y < n; ++y)
      for (let x = 0; x < n; ++x) {
        const a = sheet * (n + 1) ** 2 + y * (n + 1) + x;
        const quad = [a, a + 1, a + n + 2, a, a + n + 2, a + n + 1];
        indices.push(...(sheet === 0 ? quad : quad.reverse()));
      }
  return new SurfaceBrush(Float32Array.from(positions), Uint32Array.from(indices));
}

describe('the brush', () => {
  it('covers what is within its radius and connected, not the sheet behind', () => {
    const brush = sheets(10);
    const found = brush.within(2 * (5 * 10 + 5), [5, 5, 0], 1.01).sort((a, b) => a - b);
    const at = (x: number, y: number) => 11 * y + x;
    expect(found).toEqual([at(5, 4), at(4, 5), at(5, 5), at(6, 5), at(5, 6)]);
  });

  it('covers at least the nearest corner', () => {
    expect(sheets(4).within(0, [0.1, 0.05, 0], 0.01)).toEqual([0]);
  });

  it('knows parts, sides and the outline', () => {
    const brush = sheets(3);
    const first = Array.from({ length: 16 }, (_, v) => v);
    expect(brush.part(0).sort((a, b) => a - b)).toEqual(first);
    expect(brush.side('facing', () => [0, 0, 1])).toEqual(first);
    expect(brush.side('away', () => [0, 0, 1])).toEqual(first.map((v) => v + 16));
    expect(brush.side('outline', () => [0, 0, 1])).toEqual([]);
    // A tetrahedron seen from above: its base's corners are its outline.
    const cone = new SurfaceBrush(
      Float32Array.from([0, 0, 0, 1, 0, 0, 0, 1, 0, 0.3, 0.3, 1]),
      Uint32Array.from([0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3]),
    );
    expect(cone.side('outline', () => [0, 0, 1])).toEqual([0, 1, 2]);
    expect(cone.side('facing', () => [0, 0, 1])).toEqual([3]);
  });
});

describe('the painting of a document', () => {
  const blob = (digit: string) => ({ blob: digit.repeat(64), bytes: 1, media_type: 'x' });
  const model = { mesh: blob('a'), preview: blob('b') } as never;
  const start = relief.command({ label: 'Open' }, () => ({ model }) as never).apply(newDocument('', '', 0));

  it('goes to the operation with the model that it is painted on', () => {
    const painting = { on: 'a'.repeat(64), file: blob('c') };
    const document = relief.of(setPainting(painting, 'Paint').apply(start));
    expect(paintingInputs(document)).toEqual({
      painting: { sha256: 'c'.repeat(64), file_name: 'painting.json' },
      painted_mesh: { sha256: 'a'.repeat(64), file_name: 'model.ply' },
    });
    const { key } = subjectOf(blob('b'), 'mesh', paintingInputs(document));
    expect(key).toBe(['b', 'c', 'a'].map((digit) => digit.repeat(64)).join('+'));
  });

  it('does not go over to another model', () => {
    const document = relief.of(setPainting({ on: 'd'.repeat(64), file: blob('c') }, 'Paint').apply(start));
    expect(paintingOf(document)).toBeNull();
    expect(paintingInputs(document)).toEqual({});
    expect(paintingInputs(relief.of(start))).toEqual({});
  });
});
