// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { parseFilm, parseNodes, parsePrinted, parseSolid } from './glb';

/** Packs accessors and images as the core does: one buffer, one view each. */
class Writer {
  readonly #parts: Uint8Array[] = [];
  readonly views: object[] = [];
  readonly accessors: object[] = [];
  #size = 0;

  view(bytes: Uint8Array): number {
    this.views.push({ buffer: 0, byteOffset: this.#size, byteLength: bytes.byteLength });
    const padded = new Uint8Array(4 * Math.ceil(bytes.byteLength / 4));
    padded.set(bytes);
    this.#parts.push(padded);
    this.#size += padded.byteLength;
    return this.views.length - 1;
  }
  array(values: Float32Array | Uint32Array | Uint16Array, type: string, components: number): number {
    const bytes = new Uint8Array(values.buffer, values.byteOffset, values.byteLength);
    const componentType = values instanceof Float32Array ? 5126 : values instanceof Uint32Array ? 5125 : 5123;
    this.accessors.push({
      bufferView: this.view(bytes),
      componentType,
      count: values.length / components,
      type,
    });
    return this.accessors.length - 1;
  }
  file(json: object): Uint8Array<ArrayBuffer> {
    const whole = {
      ...json,
      bufferViews: this.views,
      accessors: this.accessors,
      buffers: [{ byteLength: this.#size }],
    };
    const text = new TextEncoder().encode(JSON.stringify(whole));
    const length = 4 * Math.ceil(text.length / 4);
    const bytes = new Uint8Array(28 + length + this.#size);
    const data = new DataView(bytes.buffer);
    [0x46546c67, 2, bytes.length, length, 0x4e4f534a].forEach((word, i) => data.setUint32(4 * i, word, true));
    bytes.fill(0x20, 20, 20 + length);
    bytes.set(text, 20);
    data.setUint32(20 + length, this.#size, true);
    data.setUint32(24 + length, 0x004e4942, true);
    let at = 28 + length;
    for (const part of this.#parts) {
      bytes.set(part, at);
      at += part.byteLength;
    }
    return bytes;
  }
}

function filmFile(times: number[]): Uint8Array<ArrayBuffer> {
  const glb = new Writer();
  const attributes = { POSITION: glb.array(Float32Array.of(0, 0, 1, 1, 0, 1, 0, 1, 1), 'VEC3', 3) };
  const target = { POSITION: glb.array(Float32Array.of(0, 0, -2, 0, 0, 0, 1, 0, 0), 'VEC3', 3) };
  const indices = glb.array(Uint32Array.of(0, 1, 2), 'SCALAR', 1);
  const extras = {
    frame_times_s: times,
    frame_phases: ['relax', 'vacuum'],
    platform_z_mm: [-120, 0],
    touching_share: [0, 0.9],
  };
  return glb.file({ meshes: [{ primitives: [{ attributes, indices, targets: [target] }], extras }] });
}

describe('a film of a sheet', () => {
  it('adds each frame to the first', () => {
    const film = parseFilm(filmFile([0, 2.5]));
    expect(film.frames.map((frame) => [...frame])).toEqual([
      [0, 0, 1, 1, 0, 1, 0, 1, 1],
      [0, 0, -1, 1, 0, 1, 1, 1, 1],
    ]);
    expect([...film.indices]).toEqual([0, 1, 2]);
    expect(film).toMatchObject({
      times_s: [0, 2.5],
      phases: ['relax', 'vacuum'],
      platform_z_mm: [-120, 0],
      touching_share: [0, 0.9],
    });
  });

  it('says what is wrong with a file', () => {
    expect(() => parseFilm(filmFile([0]))).toThrow('does not say when its frames are');
    expect(() => parseFilm(new Uint8Array(40))).toThrow('has no header');
    expect(() => parseFilm(filmFile([0, 1]).slice(0, -8))).toThrow('ends within its data');
  });
});

it('a solid stands where its node puts it, in millimetres with z up', () => {
  const glb = new Writer();
  const attributes = { POSITION: glb.array(Float32Array.of(10, 20, 30), 'VEC3', 3) };
  const indices = glb.array(Uint16Array.of(0, 0, 0), 'SCALAR', 1);
  const solid = parseSolid(
    glb.file({
      scene: 0,
      scenes: [{ nodes: [0] }],
      nodes: [{ mesh: 0, scale: [0.001, 0.001, 0.001] }],
      meshes: [{ primitives: [{ attributes, indices }] }],
    }),
  );
  [10, -30, 20].forEach((value, i) => expect(solid.positions[i]).toBeCloseTo(value, 3));
  expect([...solid.indices]).toEqual([0, 0, 0]);
});

describe('a printed sheet', () => {
  it('comes back to millimetres with z up, its picture upright', () => {
    const glb = new Writer();
    const attributes = {
      POSITION: glb.array(Float32Array.of(0.01, 0.02, 0.03), 'VEC3', 3),
      TEXCOORD_0: glb.array(Float32Array.of(0.25, 0.25), 'VEC2', 2),
    };
    const indices = glb.array(Uint16Array.of(0, 0, 0), 'SCALAR', 1);
    const image = glb.view(Uint8Array.of(1, 2, 3));
    const half = Math.sqrt(0.5);
    const printed = parsePrinted(
      glb.file({
        scene: 0,
        scenes: [{ nodes: [0] }],
        // Held in machine coordinates below a node that turns them upright.
        nodes: [
          { children: [1], rotation: [-half, 0, 0, half] },
          { mesh: 0, translation: [0, 0, 0.1] },
        ],
        meshes: [{ primitives: [{ attributes, indices, material: 0 }] }],
        materials: [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }],
        textures: [{ source: 0 }],
        images: [{ bufferView: image, mimeType: 'image/png' }],
      }),
    );
    [10, 20, 130].forEach((value, i) => expect(printed.positions[i]).toBeCloseTo(value, 3));
    expect([...printed.uvs]).toEqual([0.25, 0.75]);
    expect([...printed.picture]).toEqual([1, 2, 3]);
    expect(printed.media_type).toBe('image/png');
  });
});

describe('several meshes', () => {
  it('are read with the names of their nodes, in mm and in the axes of the file', () => {
    const glb = new Writer();
    const mesh = (x: number) => ({
      primitives: [
        {
          attributes: { POSITION: glb.array(Float32Array.of(x, 0, 1, x + 1, 0, 1, x, 2, 1), 'VEC3', 3) },
          indices: glb.array(Uint16Array.of(0, 1, 2), 'SCALAR', 1),
        },
      ],
    });
    const meshes = [mesh(0), mesh(5)];
    const node = (name: string, number: number) => ({ name, mesh: number, scale: [0.001, 0.001, 0.001] });
    const bytes = glb.file({
      scene: 0,
      scenes: [{ nodes: [0, 1] }],
      nodes: [node('Piece 1', 0), node('Piece 2', 1)],
      meshes,
    });
    const [first, second] = parseNodes(bytes);
    expect([first?.name, second?.name]).toEqual(['Piece 1', 'Piece 2']);
    expect([...(second?.positions ?? [])]).toEqual([5, 0, 1, 6, 0, 1, 5, 2, 1]);
    expect([...(second?.indices ?? [])]).toEqual([0, 1, 2]);
  });
});
