// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { apartByUv, copyNormals } from './corner_uvs';

const shading = () => ({
  indices: Uint32Array.of(0, 1, 2, 2, 1, 3),
  source: Uint32Array.of(0, 1, 2, 1),
  normals: Float32Array.of(1, 0, 0, 0, 1, 0, 0, 0, 1, 0, -1, 0),
});

describe('a picture with seams', () => {
  it('draws a vertex twice where it has two places, with its normal and its source', () => {
    // Vertex 1 lies at (1, 0) in the first triangle, at (0.5, 0.5) in the second.
    const apart = apartByUv(shading(), Float32Array.of(0, 0, 1, 0, 0, 1, 0, 1, 0.5, 0.5, 1, 1));
    expect([...apart.indices]).toEqual([0, 1, 2, 2, 4, 3]);
    expect([...apart.source]).toEqual([0, 1, 2, 1, 1]);
    expect([...apart.uvs]).toEqual([0, 0, 1, 0, 0, 1, 1, 1, 0.5, 0.5]);
    expect([...apart.normals.slice(12)]).toEqual([0, 1, 0]);
  });

  it('leaves a mesh without seams as it is', () => {
    const apart = apartByUv(shading(), Float32Array.of(0, 0, 1, 0, 0, 1, 0, 1, 1, 0, 1, 1));
    expect([...apart.indices]).toEqual([...shading().indices]);
    expect([...apart.source]).toEqual([...shading().source]);
  });

  it('gives copies the normals of what was turned', () => {
    const apart = apartByUv(shading(), Float32Array.of(0, 0, 1, 0, 0, 1, 0, 1, 0.5, 0.5, 1, 1));
    const turned = shading().normals.map((value) => -value);
    copyNormals(turned, apart);
    expect([...apart.normals]).toEqual([...turned, ...turned.slice(3, 6)]);
  });
});
