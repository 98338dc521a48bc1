// SPDX-License-Identifier: GPL-3.0-or-later
// A reader for binary glTF as the core writes it: one buffer, packed accessors. Format: Khronos glTF 2.0.
// Scenes are metres with y up; what is returned is millimetres with z up, as the core computes.
import type { Json, JsonObject } from './contract';

/** A sheet that changes its shape over time. */
export interface Film {
  /** Three vertex numbers per triangle. */
  readonly indices: Uint32Array<ArrayBuffer>;
  /** x, y, z per vertex for each frame, mm, clamp at rest. */
  readonly frames: readonly Float32Array<ArrayBuffer>[];
  readonly times_s: readonly number[];
  readonly phases: readonly string[];
  /** How far the platform is below its final place, at most 0. */
  readonly platform_z_mm: readonly number[];
  readonly touching_share: readonly number[];
}

export interface Solid {
  readonly positions: Float32Array<ArrayBuffer>;
  readonly indices: Uint32Array<ArrayBuffer>;
}

/** One of several meshes, in the axes of the file: mm, y up, z towards the viewer. */
export interface NamedSolid extends Solid {
  readonly name: string;
}

/** A mesh with its picture. */
export interface Printed extends Solid {
  /** u, v per vertex, origin at the picture's lower left. */
  readonly uvs: Float32Array<ArrayBuffer>;
  readonly picture: Uint8Array<ArrayBuffer>;
  readonly media_type: string;
}

const fail = (what: string): never => {
  throw new Error(`The GLB file ${what}.`);
};

const object = (value: Json | undefined): JsonObject =>
  typeof value === 'object' && value !== null && !Array.isArray(value) ? (value as JsonObject) : {};
const list = (value: Json | undefined): readonly Json[] => (Array.isArray(value) ? (value as Json[]) : []);
const numbers = (value: Json | undefined): number[] => list(value).map(Number);

const components: Readonly<Record<string, number>> = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };

class Glb {
  readonly json: JsonObject;
  readonly #binary: Uint8Array<ArrayBuffer>;

  constructor(bytes: Uint8Array<ArrayBuffer>) {
    const data = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    if (bytes.byteLength < 20 || data.getUint32(0, true) !== 0x46546c67) fail('has no header');
    const length = data.getUint32(12, true);
    const end = 20 + length;
    if (end > bytes.byteLength) fail('ends within its description');
    this.json = object(JSON.parse(new TextDecoder().decode(bytes.subarray(20, end))) as Json);
    const size = end + 8 <= bytes.byteLength ? data.getUint32(end, true) : 0;
    if (end + 8 + size > bytes.byteLength) fail('ends within its data');
    // A copy of its own starts at a whole word.
    this.#binary = bytes.slice(end + 8, end + 8 + size);
  }

  at(name: string, index: Json | undefined): JsonObject {
    const found = list(this.json[name])[Number(index ?? NaN)];
    return found === undefined ? fail(`names one of its ${name} that it does not have`) : object(found);
  }

  view(index: Json | undefined, offset = 0): Uint8Array<ArrayBuffer> {
    const view = this.at('bufferViews', index);
    const start = Number(view['byteOffset'] ?? 0);
    const end = start + Number(view['byteLength']);
    if (!(end <= this.#binary.byteLength)) fail('ends before its data');
    return this.#binary.subarray(start + offset, end);
  }

  floats(index: Json | undefined): Float32Array<ArrayBuffer> {
    const accessor = this.at('accessors', index);
    if (accessor['componentType'] !== 5126) fail('has an attribute that is not single precision');
    const count = Number(accessor['count']) * (components[String(accessor['type'])] ?? 0);
    const bytes = this.view(accessor['bufferView'], Number(accessor['byteOffset'] ?? 0));
    if (bytes.byteLength < 4 * count) fail('ends before its last vertex');
    return new Float32Array(bytes.slice(0, 4 * count).buffer);
  }

  integers(index: Json | undefined): Uint32Array<ArrayBuffer> {
    const accessor = this.at('accessors', index);
    const count = Number(accessor['count']);
    const bytes = this.view(accessor['bufferView'], Number(accessor['byteOffset'] ?? 0));
    const size =
      { 5121: 1, 5123: 2, 5125: 4 }[Number(accessor['componentType'])] ??
      fail('names vertices that it does not have');
    if (bytes.byteLength < size * count) fail('ends before its last triangle');
    const { buffer } = bytes.slice(0, size * count);
    if (size === 4) return new Uint32Array(buffer);
    return Uint32Array.from(size === 2 ? new Uint16Array(buffer) : new Uint8Array(buffer));
  }
}

/** Throws Error with one sentence for what is not such a film. */
export function parseFilm(bytes: Uint8Array<ArrayBuffer>): Film {
  const glb = new Glb(bytes);
  const mesh = glb.at('meshes', 0);
  const primitive = object(list(mesh['primitives'])[0]);
  const extras = object(mesh['extras']);
  const base = glb.floats(object(primitive['attributes'])['POSITION']);
  const frames = [base];
  for (const target of list(primitive['targets'])) {
    const moved = glb.floats(object(target)['POSITION']);
    if (moved.length !== base.length) fail('has a frame of another sheet');
    frames.push(moved.map((value, i) => value + (base[i] ?? 0)));
  }
  const times_s = numbers(extras['frame_times_s']);
  if (times_s.length !== frames.length) fail('does not say when its frames are');
  const share = numbers(extras['touching_share']);
  const platform = numbers(extras['platform_z_mm']);
  const whole = (values: number[], otherwise: number) => frames.map((_, i) => values[i] ?? otherwise);
  return {
    indices: glb.integers(primitive['indices']),
    frames,
    times_s,
    phases: list(extras['frame_phases']).map(String),
    platform_z_mm: whole(platform, 0),
    touching_share: whole(share, 0),
  };
}

type Matrix = readonly number[]; // 4 x 4, column by column, as glTF has it

function nodeMatrix(node: JsonObject): Matrix {
  if (node['matrix']) return numbers(node['matrix']);
  const [x = 0, y = 0, z = 0, w = 1] = numbers(node['rotation']);
  const [sx = 1, sy = 1, sz = 1] = numbers(node['scale']);
  const [tx = 0, ty = 0, tz = 0] = numbers(node['translation']);
  return [
    sx * (1 - 2 * (y * y + z * z)), sx * 2 * (x * y + z * w), sx * 2 * (x * z - y * w), 0,
    sy * 2 * (x * y - z * w), sy * (1 - 2 * (x * x + z * z)), sy * 2 * (y * z + x * w), 0,
    sz * 2 * (x * z + y * w), sz * 2 * (y * z - x * w), sz * (1 - 2 * (x * x + y * y)), 0,
    tx, ty, tz, 1,
  ]; // prettier-ignore
}

const product = (a: Matrix, b: Matrix): Matrix =>
  Array.from({ length: 16 }, (_, at) =>
    [0, 1, 2, 3].reduce(
      (sum, k) => sum + (a[4 * k + (at % 4)] ?? 0) * (b[4 * Math.floor(at / 4) + k] ?? 0),
      0,
    ),
  );

/** From the scene's root to the first node that shows `mesh`. */
function worldMatrix(glb: Glb, mesh: number): Matrix {
  const search = (index: Json, above: Matrix, depth: number): Matrix | null => {
    if (depth > 16) return null;
    const node = glb.at('nodes', index);
    const here = product(above, nodeMatrix(node));
    if (node['mesh'] === mesh) return here;
    for (const child of list(node['children'])) {
      const found = search(child, here, depth + 1);
      if (found) return found;
    }
    return null;
  };
  const identity = nodeMatrix({});
  for (const root of list(glb.at('scenes', glb.json['scene'] ?? 0)['nodes'])) {
    const found = search(root, identity, 0);
    if (found) return found;
  }
  return identity;
}

function solidOf(glb: Glb, primitive: JsonObject): Solid {
  const attributes = object(primitive['attributes']);
  const m = worldMatrix(glb, 0);
  const from = glb.floats(attributes['POSITION']);
  const positions = new Float32Array(from.length);
  for (let i = 0; i < from.length; i += 3) {
    const [x = 0, y = 0, z = 0] = [from[i], from[i + 1], from[i + 2]];
    const metres = (row: number) =>
      (m[row] ?? 0) * x + (m[4 + row] ?? 0) * y + (m[8 + row] ?? 0) * z + (m[12 + row] ?? 0);
    positions[i] = 1000 * metres(0);
    positions[i + 1] = -1000 * metres(2);
    positions[i + 2] = 1000 * metres(1);
  }
  return { positions, indices: glb.integers(primitive['indices']) };
}

const firstPrimitive = (glb: Glb): JsonObject => object(list(glb.at('meshes', 0)['primitives'])[0]);

/** The first mesh where it stands. Throws Error with one sentence for what has none. */
export function parseSolid(bytes: Uint8Array<ArrayBuffer>): Solid {
  const glb = new Glb(bytes);
  return solidOf(glb, firstPrimitive(glb));
}

/** Every mesh that a root of the scene shows. Throws Error with one sentence. */
export function parseNodes(bytes: Uint8Array<ArrayBuffer>): NamedSolid[] {
  const glb = new Glb(bytes);
  return list(glb.at('scenes', glb.json['scene'] ?? 0)['nodes']).map((root) => {
    const node = glb.at('nodes', root);
    const primitive = object(list(glb.at('meshes', node['mesh'])['primitives'])[0]);
    const [scale = 1] = numbers(node['scale']);
    return {
      name: String(node['name'] ?? ''),
      positions: glb
        .floats(object(primitive['attributes'])['POSITION'])
        .map((metres) => 1000 * scale * metres),
      indices: glb.integers(primitive['indices']),
    };
  });
}

/** The first mesh with its base colour picture. Throws Error with one sentence. */
export function parsePrinted(bytes: Uint8Array<ArrayBuffer>): Printed {
  const glb = new Glb(bytes);
  const primitive = firstPrimitive(glb);
  const attributes = object(primitive['attributes']);
  const uvs = glb.floats(attributes['TEXCOORD_0']).map((value, i) => (i % 2 === 0 ? value : 1 - value));
  const material = object(glb.at('materials', primitive['material'])['pbrMetallicRoughness']);
  const texture = glb.at('textures', object(material['baseColorTexture'])['index']);
  const image = glb.at('images', texture['source']);
  return {
    ...solidOf(glb, primitive),
    uvs,
    picture: glb.view(image['bufferView']).slice(),
    media_type: String(image['mimeType'] ?? 'image/png'),
  };
}

/** The picture of a scene that has exactly one. Throws Error with one sentence for what is no such file. */
export function onlyPicture(
  bytes: Uint8Array<ArrayBuffer>,
): { readonly picture: Uint8Array<ArrayBuffer>; readonly media_type: string } | null {
  const glb = new Glb(bytes);
  const images = list(glb.json['images']).map(object);
  const [image] = images;
  if (image === undefined || images.length > 1) return null;
  return {
    picture: glb.view(image['bufferView']).slice(),
    media_type: String(image['mimeType'] ?? 'image/png'),
  };
}
