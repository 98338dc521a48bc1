// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes and file formats for the mock backend; as small as will do.

export interface Mesh {
  readonly positions: Float64Array;
  readonly indices: Uint32Array;
}

/** A closed grid of rows x columns vertices on a sphere or torus, bumpy. */
export function sampleMesh(name: string, vertices: number): Mesh {
  const rows = Math.max(8, Math.round(Math.sqrt(vertices / 2)));
  const columns = 2 * rows;
  const positions = new Float64Array(3 * rows * columns);
  const indices: number[] = [];
  const torus = name === 'torus';
  for (let i = 0; i < rows; ++i)
    for (let j = 0; j < columns; ++j) {
      const v = torus ? (2 * Math.PI * i) / rows : (Math.PI * (i + 0.5)) / rows;
      const u = (2 * Math.PI * j) / columns;
      const r = 1 + 0.08 * Math.sin(5 * u) * Math.sin(6 * v) + 0.02 * Math.sin(17 * u + 9 * v);
      const ring = torus ? 2 + 0.8 * r * Math.cos(v) : r * Math.sin(v);
      const height = torus ? 0.8 * r * Math.sin(v) : 1.4 * r * Math.cos(v);
      positions.set([20 * ring * Math.sin(u), 20 * height, 20 * ring * Math.cos(u)], 3 * (i * columns + j));
      if (!torus && i === rows - 1) continue;
      const [a, b] = [i * columns + j, i * columns + ((j + 1) % columns)];
      const [c, d] = [((i + 1) % rows) * columns + j, ((i + 1) % rows) * columns + ((j + 1) % columns)];
      indices.push(a, c, b, b, c, d);
    }
  return { positions, indices: new Uint32Array(indices) };
}

export function readObj(bytes: Uint8Array): Mesh {
  const positions: number[] = [];
  const indices: number[] = [];
  for (const line of new TextDecoder().decode(bytes).split('\n')) {
    const words = line.trim().split(/\s+/);
    if (words[0] === 'v') positions.push(Number(words[1]), Number(words[2]), Number(words[3]));
    if (words[0] !== 'f') continue;
    const corners = words.slice(1).map((word) => Number.parseInt(word) - 1);
    for (let i = 2; i < corners.length; ++i)
      indices.push(corners[0] ?? 0, corners[i - 1] ?? 0, corners[i] ?? 0);
  }
  return { positions: new Float64Array(positions), indices: new Uint32Array(indices) };
}

export function writePly(
  mesh: Mesh,
  columns: Readonly<Record<string, Float64Array>> = {},
): Uint8Array<ArrayBuffer> {
  const names = Object.keys(columns);
  const [vertices, faces] = [mesh.positions.length / 3, mesh.indices.length / 3];
  const properties = ['x', 'y', 'z', ...names].map((name) => `property double ${name}\n`).join('');
  const header = new TextEncoder().encode(
    `ply\nformat binary_little_endian 1.0\nelement vertex ${vertices}\n${properties}` +
      `element face ${faces}\nproperty list uchar int vertex_indices\nend_header\n`,
  );
  const stride = 8 * (3 + names.length);
  const bytes = new Uint8Array(header.length + stride * vertices + 13 * faces);
  bytes.set(header);
  const data = new DataView(bytes.buffer);
  let at = header.length;
  for (let i = 0; i < vertices; ++i) {
    for (let k = 0; k < 3; ++k, at += 8) data.setFloat64(at, mesh.positions[3 * i + k] ?? 0, true);
    for (const name of names) {
      data.setFloat64(at, columns[name]?.[i] ?? 0, true);
      at += 8;
    }
  }
  for (let i = 0; i < faces; ++i) {
    data.setUint8(at, 3);
    for (let k = 0; k < 3; ++k) data.setInt32(at + 1 + 4 * k, mesh.indices[3 * i + k] ?? 0, true);
    at += 13;
  }
  return bytes;
}

export function writeStl(mesh: Mesh): Uint8Array<ArrayBuffer> {
  const faces = mesh.indices.length / 3;
  const bytes = new Uint8Array(84 + 50 * faces);
  const data = new DataView(bytes.buffer);
  data.setUint32(80, faces, true);
  for (let i = 0; i < faces; ++i)
    for (let k = 0; k < 9; ++k) {
      const vertex = mesh.indices[3 * i + Math.floor(k / 3)] ?? 0;
      data.setFloat32(84 + 50 * i + 12 + 4 * k, mesh.positions[3 * vertex + (k % 3)] ?? 0, true);
    }
  return bytes;
}
