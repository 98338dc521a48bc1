// SPDX-License-Identifier: GPL-3.0-or-later
// A reader for binary little-endian PLY as the core writes it: scalar vertex properties of any type in any
// order, triangles as lists. Format: G. Turk, "The PLY polygon file format", 1994.

export interface PlyMesh {
  /** x, y, z per vertex. */
  readonly positions: Float32Array<ArrayBuffer>;
  /** Three vertex numbers per triangle. */
  readonly indices: Uint32Array<ArrayBuffer>;
  /** r, g, b in 0..1 per vertex, if the file has colours. */
  readonly colours?: Float32Array<ArrayBuffer>;
  /** u, v of each corner of each triangle, origin at the picture's lower left, if the file has them. */
  readonly cornerUvs?: Float32Array<ArrayBuffer>;
  /** All further scalar vertex properties by name. */
  readonly attributes: Readonly<Record<string, Float32Array<ArrayBuffer>>>;
}

type Scalar = 'int8' | 'uint8' | 'int16' | 'uint16' | 'int32' | 'uint32' | 'float32' | 'float64';
const scalarNames: Readonly<Record<string, Scalar>> = {
  char: 'int8', int8: 'int8', uchar: 'uint8', uint8: 'uint8', short: 'int16', int16: 'int16',
  ushort: 'uint16', uint16: 'uint16', int: 'int32', int32: 'int32', uint: 'uint32', uint32: 'uint32',
  float: 'float32', float32: 'float32', double: 'float64', float64: 'float64',
}; // prettier-ignore
const scalarBytes: Readonly<Record<Scalar, number>> = {
  int8: 1, uint8: 1, int16: 2, uint16: 2, int32: 4, uint32: 4, float32: 4, float64: 8,
}; // prettier-ignore

interface Property {
  readonly name: string;
  readonly type: Scalar;
  /** Type of the length of a list; null for a scalar. */
  readonly count: Scalar | null;
}

interface Element {
  readonly name: string;
  readonly count: number;
  readonly properties: Property[];
}

const fail = (what: string): never => {
  throw new Error(`The PLY file ${what}.`);
};

function scalar(name: string | undefined): Scalar {
  return scalarNames[name ?? ''] ?? fail(`has a property of unknown type “${name ?? ''}”`);
}

interface Header {
  readonly elements: Element[];
  /** Of its `TextureFile` comments. */
  readonly pictures: string[];
  readonly bodyStart: number;
}

function readHeader(bytes: Uint8Array): Header {
  const text = new TextDecoder('latin1').decode(bytes.subarray(0, 65536));
  const end = /end_header\r?\n/.exec(text);
  if (!text.startsWith('ply') || end === null) return fail('has no header');
  const elements: Element[] = [];
  const pictures: string[] = [];
  for (const line of text.slice(0, end.index).split(/\r?\n/)) {
    const words = line.trim().split(/\s+/);
    const element = elements.at(-1);
    if (words[0] === 'format' && words[1] !== 'binary_little_endian') fail('is not binary little-endian');
    if (words[0] === 'comment' && words[1] === 'TextureFile') pictures.push(words.slice(2).join(' '));
    if (words[0] === 'element')
      elements.push({ name: words[1] ?? '', count: Number(words[2]), properties: [] });
    if (words[0] !== 'property' || element === undefined) continue;
    if (words[1] === 'list')
      element.properties.push({ name: words[4] ?? '', type: scalar(words[3]), count: scalar(words[2]) });
    else element.properties.push({ name: words[2] ?? '', type: scalar(words[1]), count: null });
  }
  return { elements, pictures, bodyStart: end.index + end[0].length };
}

/** Whether a PLY places a picture on its triangles, and the pictures that it names. */
export function plyPictures(bytes: Uint8Array): { placed: boolean; names: readonly string[] } {
  const { elements, pictures } = readHeader(bytes);
  const has = (element: string, property: string) =>
    elements.some(
      ({ name, properties }) => name === element && properties.some((known) => known.name === property),
    );
  return {
    placed: has('face', 'texcoord') || (has('vertex', 's') && has('vertex', 't')),
    names: pictures,
  };
}

function read(data: DataView, type: Scalar, at: number): number {
  switch (type) {
    case 'int8': return data.getInt8(at);
    case 'uint8': return data.getUint8(at);
    case 'int16': return data.getInt16(at, true);
    case 'uint16': return data.getUint16(at, true);
    case 'int32': return data.getInt32(at, true);
    case 'uint32': return data.getUint32(at, true);
    case 'float32': return data.getFloat32(at, true);
    case 'float64': return data.getFloat64(at, true);
  } // prettier-ignore
}

interface Column {
  readonly type: Scalar;
  readonly offset: number;
  readonly target: Float32Array;
  readonly stride: number;
  readonly first: number;
  readonly scale: number;
}

/** Throws Error with one sentence for a file that is not such a PLY or ends early. */
export function parsePly(bytes: Uint8Array): PlyMesh {
  const { elements, bodyStart } = readHeader(bytes);
  const data = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  let at = bodyStart;
  let positions = new Float32Array(0);
  let indices = new Uint32Array(0);
  let cornerUvs: Float32Array<ArrayBuffer> | undefined;
  let colours: Float32Array<ArrayBuffer> | undefined;
  const attributes: Record<string, Float32Array<ArrayBuffer>> = {};

  for (const element of elements) {
    if (element.name === 'vertex') {
      const columns: Column[] = [];
      let offset = 0;
      positions = new Float32Array(3 * element.count);
      for (const { name, type, count } of element.properties) {
        if (count !== null) fail('has a list among its vertex properties');
        const axis = ['x', 'y', 'z'].indexOf(name);
        const channel = ['red', 'green', 'blue'].indexOf(name);
        if (axis >= 0) columns.push({ type, offset, target: positions, stride: 3, first: axis, scale: 1 });
        else if (channel >= 0) {
          colours ??= new Float32Array(3 * element.count);
          const scale = type === 'uint8' ? 1 / 255 : 1;
          columns.push({ type, offset, target: colours, stride: 3, first: channel, scale });
        } else {
          const target = (attributes[name] = new Float32Array(element.count));
          columns.push({ type, offset, target, stride: 1, first: 0, scale: 1 });
        }
        offset += scalarBytes[type];
      }
      if (at + offset * element.count > data.byteLength) fail('ends before its last vertex');
      for (const { type, offset: within, target, stride, first, scale } of columns) {
        let from = at + within;
        for (let i = 0, to = first; i < element.count; ++i, to += stride, from += offset)
          target[to] = read(data, type, from) * scale;
      }
      at += offset * element.count;
    } else if (element.name === 'face') {
      ({ indices, cornerUvs, at } = readFaces(data, at, element));
    } else {
      at = skip(data, at, element);
    }
  }
  const vertices = positions.length / 3;
  for (const index of indices) if (index >= vertices) fail('names a vertex that it does not have');
  const { s, t } = attributes;
  if (s && t && cornerUvs === undefined) {
    cornerUvs = new Float32Array(2 * indices.length);
    for (const [corner, vertex] of indices.entries()) {
      cornerUvs[2 * corner] = s[vertex] ?? 0;
      cornerUvs[2 * corner + 1] = t[vertex] ?? 0;
    }
  }
  return {
    positions,
    indices,
    ...(colours ? { colours } : {}),
    ...(cornerUvs ? { cornerUvs } : {}),
    attributes,
  };
}

interface Faces {
  readonly indices: Uint32Array<ArrayBuffer>;
  readonly cornerUvs: Float32Array<ArrayBuffer> | undefined;
  /** Where the next element begins. */
  readonly at: number;
}

/** Polygons become fans of triangles. Texture coordinates are read where every face is a triangle that has them. */
function readFaces(data: DataView, start: number, element: Element): Faces {
  let indices = new Uint32Array(3 * element.count);
  const placed = element.properties.some(({ name, count }) => name === 'texcoord' && count !== null);
  const uvs = placed ? new Float32Array(6 * element.count) : null;
  let placedFaces = 0;
  let used = 0;
  let at = start;
  try {
    for (let face = 0; face < element.count; ++face)
      for (const { name, type, count } of element.properties) {
        if (count === null) {
          at += scalarBytes[type];
          continue;
        }
        const corners = read(data, count, at);
        at += scalarBytes[count];
        const size = scalarBytes[type];
        if (name === 'vertex_indices' || name === 'vertex_index') {
          if (used + 3 * Math.max(0, corners - 2) > indices.length) {
            const larger = new Uint32Array(2 * indices.length + 3 * corners);
            larger.set(indices);
            indices = larger;
          }
          for (let corner = 2; corner < corners; ++corner) {
            indices[used++] = read(data, type, at);
            indices[used++] = read(data, type, at + (corner - 1) * size);
            indices[used++] = read(data, type, at + corner * size);
          }
        }
        if (uvs && name === 'texcoord' && corners === 6) {
          for (let k = 0; k < 6; ++k) uvs[6 * face + k] = read(data, type, at + k * size);
          ++placedFaces;
        }
        at += corners * size;
      }
  } catch {
    fail('ends before its last face');
  }
  if (at > data.byteLength) fail('ends before its last face');
  const complete = uvs !== null && placedFaces === element.count && used === 3 * element.count;
  return {
    indices: used === indices.length ? indices : indices.slice(0, used),
    cornerUvs: complete ? uvs : undefined,
    at,
  };
}

function skip(data: DataView, start: number, element: Element): number {
  let at = start;
  for (let i = 0; i < element.count; ++i)
    for (const { type, count } of element.properties) {
      const items = count === null ? 1 : read(data, count, at);
      at += (count === null ? 0 : scalarBytes[count]) + items * scalarBytes[type];
    }
  return at;
}
