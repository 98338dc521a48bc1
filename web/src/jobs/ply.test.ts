// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { sampleMesh, writePly } from './mock/meshes';
import { parsePly, plyPictures } from './ply';

function ply(header: string, body: number[]): Uint8Array {
  const text = new TextEncoder().encode(`ply\nformat binary_little_endian 1.0\n${header}end_header\n`);
  return new Uint8Array([...text, ...body]);
}
const float = (value: number) => [...new Uint8Array(new Float32Array([value]).buffer)];
const int = (value: number) => [...new Uint8Array(new Int32Array([value]).buffer)];
const corner = (x: number, y: number, z: number) => [x, y, z].flatMap(float);
const vertices = (count: number, more = '') =>
  `element vertex ${count}\nproperty float x\nproperty float y\nproperty float z\n${more}`;
const faces = (count: number) => `element face ${count}\nproperty list uchar int vertex_indices\n`;

describe('parsePly', () => {
  it('reads back what the core writes: double positions, doubles beside them, uchar int lists', () => {
    const mesh = sampleMesh('torus', 500);
    const lambda = mesh.positions.filter((_, i) => i % 3 === 0);
    const read = parsePly(writePly(mesh, { lambda }));
    expect(read.indices).toEqual(mesh.indices);
    expect(read.positions).toEqual(new Float32Array(mesh.positions));
    expect(read.attributes['lambda']).toEqual(new Float32Array(lambda));
  });

  it('reads properties in any order and scales colours', () => {
    const header =
      'element vertex 1\nproperty uchar red\nproperty float z\nproperty float x\nproperty float y\n' +
      'property uchar green\nproperty uchar blue\nproperty uchar visible\n';
    const read = parsePly(ply(header, [255, ...float(3), ...float(1), ...float(2), 0, 51, 1]));
    expect([...read.positions]).toEqual([1, 2, 3]);
    expect([...(read.colours ?? [])].map((c) => c.toFixed(2))).toEqual(['1.00', '0.00', '0.20']);
    expect([...(read.attributes['visible'] ?? [])]).toEqual([1]);
  });

  const triangle = [corner(0, 0, 0), corner(1, 0, 0), corner(0, 1, 0)].flat();
  const texcoord = 'property list uchar float texcoord\n';

  it('reads where corners lie in a picture, from its faces or from its vertices', () => {
    const uvs = [0, 0.25, 1, 0.5, 0, 0.75];
    const face = [3, ...[0, 1, 2].flatMap(int), 6, ...uvs.flatMap(float)];
    const read = parsePly(ply(vertices(3) + faces(1) + texcoord, [...triangle, ...face]));
    expect([...(read.cornerUvs ?? [])]).toEqual(uvs);

    const columns = 'property float s\nproperty float t\n';
    const body = [0, 1, 2].flatMap((v) => [
      ...triangle.slice(12 * v, 12 * v + 12),
      ...float(v),
      ...float(v / 4),
    ]);
    const turned = parsePly(ply(vertices(3, columns) + faces(1), [...body, 3, ...[2, 0, 1].flatMap(int)]));
    expect([...(turned.cornerUvs ?? [])]).toEqual([2, 0.5, 0, 0, 1, 0.25]);
  });

  it('places no picture where a face does not say where it lies', () => {
    const bare = [3, ...[0, 1, 2].flatMap(int), 0];
    const read = parsePly(ply(vertices(3) + faces(1) + texcoord, [...triangle, ...bare]));
    expect(read.cornerUvs).toBeUndefined();
    expect([...read.indices]).toEqual([0, 1, 2]);
  });

  it('names the pictures of its header', () => {
    const named = ply('comment TextureFile my cat.png\n' + vertices(0) + faces(0) + texcoord, []);
    expect(plyPictures(named)).toEqual({ placed: true, names: ['my cat.png'] });
    expect(plyPictures(ply(vertices(0) + faces(0), []))).toEqual({ placed: false, names: [] });
  });

  it('turns polygons into fans', () => {
    const square = [corner(0, 0, 0), corner(1, 0, 0), corner(1, 1, 0), corner(0, 1, 0)].flat();
    const read = parsePly(ply(vertices(4) + faces(1), [...square, 4, ...[0, 1, 2, 3].flatMap(int)]));
    expect([...read.indices]).toEqual([0, 1, 2, 0, 2, 3]);
  });

  it('skips elements it does not know', () => {
    const header = `element scan 2\nproperty short gain\nproperty list uchar float v\n${vertices(1)}`;
    const read = parsePly(ply(header, [0, 0, 1, ...float(9), 0, 0, 0, ...corner(4, 5, 6)]));
    expect([...read.positions]).toEqual([4, 5, 6]);
  });

  it.each([
    ['no header', new Uint8Array([1, 2, 3]), /has no header/],
    ['a missing vertex', ply(vertices(2), corner(0, 0, 0)), /ends before its last vertex/],
    [
      'a missing face',
      ply(vertices(1) + faces(2), [...corner(0, 0, 0), 3, ...int(0)]),
      /ends before its last face/,
    ],
    [
      'an index out of range',
      ply(vertices(1) + faces(1), [...corner(0, 0, 0), 3, ...[0, 1, 0].flatMap(int)]),
      /vertex/,
    ],
    ['text', new TextEncoder().encode('ply\nformat ascii 1.0\nend_header\n'), /not binary little-endian/],
  ])('refuses %s in a sentence', (_, bytes, sentence) => {
    expect(() => parsePly(bytes)).toThrow(sentence);
  });
});
