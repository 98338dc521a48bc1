// SPDX-License-Identifier: GPL-3.0-or-later
/* eslint-disable @typescript-eslint/no-non-null-assertion -- indices stay within the arrays' own lengths */
// Normals for shading: smooth over the mesh, sharp at creases.
//
// A vertex where faces meet at more than the crease angle is drawn several times, once per smooth fan. The
// splitting is found once per topology; live positions only recompute normals.

const CREASE_COSINE = Math.cos((45 * Math.PI) / 180);
/** A corner this close to the vertex normal cannot belong to a crease worth splitting. */
const SURELY_SMOOTH_COSINE = Math.cos((24 * Math.PI) / 180);

export interface Shading {
  /** Triangle corners into drawn vertices; same triangles, same order. */
  indices: Uint32Array;
  /** Mesh vertex of each drawn vertex; the first are the mesh's own, in order. */
  source: Uint32Array;
  /** Unit normals of the drawn vertices. */
  normals: Float32Array;
}

/** Cross products of the triangles' edges: twice the area long, outward. */
function faceNormals(positions: ArrayLike<number>, indices: Uint32Array, out: Float32Array): void {
  for (let t = 0; t < indices.length; t += 3) {
    const a = 3 * indices[t]!;
    const b = 3 * indices[t + 1]!;
    const c = 3 * indices[t + 2]!;
    const ax = positions[a]!;
    const ay = positions[a + 1]!;
    const az = positions[a + 2]!;
    const ux = positions[b]! - ax;
    const uy = positions[b + 1]! - ay;
    const uz = positions[b + 2]! - az;
    const vx = positions[c]! - ax;
    const vy = positions[c + 1]! - ay;
    const vz = positions[c + 2]! - az;
    out[t] = uy * vz - uz * vy;
    out[t + 1] = uz * vx - ux * vz;
    out[t + 2] = ux * vy - uy * vx;
  }
}

function accumulate(indices: Uint32Array, faces: Float32Array, normals: Float32Array): void {
  for (let t = 0; t < indices.length; t += 3) {
    const x = faces[t]!;
    const y = faces[t + 1]!;
    const z = faces[t + 2]!;
    for (let k = 0; k < 3; ++k) {
      const v = 3 * indices[t + k]!;
      normals[v] = normals[v]! + x;
      normals[v + 1] = normals[v + 1]! + y;
      normals[v + 2] = normals[v + 2]! + z;
    }
  }
}

/** Scales to unit length; a vertex without any area gets +z, so that nothing turns into NaN. */
function toUnit(normals: Float32Array): void {
  for (let v = 0; v < normals.length; v += 3) {
    const x = normals[v]!;
    const y = normals[v + 1]!;
    const z = normals[v + 2]!;
    const l = Math.sqrt(x * x + y * y + z * z);
    if (l > 0) {
      normals[v] = x / l;
      normals[v + 1] = y / l;
      normals[v + 2] = z / l;
    } else {
      normals[v] = 0;
      normals[v + 1] = 0;
      normals[v + 2] = 1;
    }
  }
}

/** Area-weighted vertex normals, no creases. */
export function smoothNormals(
  positions: ArrayLike<number>,
  indices: Uint32Array,
  vertexCount: number,
): Float32Array {
  const faces = new Float32Array(indices.length);
  const normals = new Float32Array(3 * vertexCount);
  faceNormals(positions, indices, faces);
  accumulate(indices, faces, normals);
  toUnit(normals);
  return normals;
}

/** Finds creases and the normals on both sides of them. */
export function shadingFor(positions: ArrayLike<number>, indices: Uint32Array): Shading {
  const vertexCount = positions.length / 3;
  const faces = new Float32Array(indices.length);
  faceNormals(positions, indices, faces);
  const smooth = new Float32Array(3 * vertexCount);
  accumulate(indices, faces, smooth);
  toUnit(smooth);
  toUnitFaces(faces);

  // Vertices with a face far from their smooth normal.
  const suspect = new Uint8Array(vertexCount);
  let suspects = 0;
  for (let t = 0; t < indices.length; t += 3) {
    const x = faces[t]!;
    const y = faces[t + 1]!;
    const z = faces[t + 2]!;
    for (let k = 0; k < 3; ++k) {
      const v = indices[t + k]!;
      if (
        suspect[v] === 0 &&
        x * smooth[3 * v]! + y * smooth[3 * v + 1]! + z * smooth[3 * v + 2]! < SURELY_SMOOTH_COSINE
      ) {
        suspect[v] = 1;
        ++suspects;
      }
    }
  }
  const source = new Uint32Array(vertexCount);
  for (let v = 0; v < vertexCount; ++v) source[v] = v;
  if (suspects === 0) return { indices, source, normals: smooth };

  const corners = new Map<number, number[]>();
  for (let c = 0; c < indices.length; ++c) {
    const v = indices[c]!;
    if (suspect[v] !== 1) continue;
    const list = corners.get(v);
    if (list) list.push(c);
    else corners.set(v, [c]);
  }
  const drawn = indices.slice();
  const extra: number[] = [];
  for (const [v, list] of corners) {
    const fans = smoothFans(list, indices, faces);
    // The first fan keeps the mesh's vertex.
    for (let f = 1; f < fans.length; ++f) {
      const drawnVertex = vertexCount + extra.length;
      extra.push(v);
      for (const c of fans[f]!) drawn[c] = drawnVertex;
    }
  }
  if (extra.length === 0) return { indices, source, normals: smooth };
  const allSource = new Uint32Array(vertexCount + extra.length);
  allSource.set(source);
  allSource.set(extra, vertexCount);
  const shading = { indices: drawn, source: allSource, normals: new Float32Array(3 * allSource.length) };
  updateNormals(shading, positions, indices);
  return shading;
}

function toUnitFaces(faces: Float32Array): void {
  for (let t = 0; t < faces.length; t += 3) {
    const l = Math.sqrt(
      faces[t]! * faces[t]! + faces[t + 1]! * faces[t + 1]! + faces[t + 2]! * faces[t + 2]!,
    );
    const s = l > 0 ? 1 / l : 0;
    faces[t] = faces[t]! * s;
    faces[t + 1] = faces[t + 1]! * s;
    faces[t + 2] = faces[t + 2]! * s;
  }
}

/** Groups the corners of one vertex: triangles joined by an edge there, less than the crease angle apart. */
function smoothFans(list: number[], indices: Uint32Array, faces: Float32Array): number[][] {
  const group = list.map((_, i) => i);
  const root = (i: number): number => {
    let r = i;
    while (group[r] !== r) r = group[r]!;
    return r;
  };
  for (let i = 0; i < list.length; ++i) {
    const ti = list[i]! - (list[i]! % 3);
    const ni = othersOf(list[i]!, indices);
    for (let j = 0; j < i; ++j) {
      const nj = othersOf(list[j]!, indices);
      if (ni[0] !== nj[0] && ni[0] !== nj[1] && ni[1] !== nj[0] && ni[1] !== nj[1]) continue;
      const tj = list[j]! - (list[j]! % 3);
      const cosine =
        faces[ti]! * faces[tj]! + faces[ti + 1]! * faces[tj + 1]! + faces[ti + 2]! * faces[tj + 2]!;
      if (cosine >= CREASE_COSINE) group[root(i)] = root(j);
    }
  }
  const fans = new Map<number, number[]>();
  list.forEach((c, i) => {
    const r = root(i);
    const fan = fans.get(r);
    if (fan) fan.push(c);
    else fans.set(r, [c]);
  });
  return [...fans.values()];
}

/** The two other vertices of the triangle at corner c. */
function othersOf(c: number, indices: Uint32Array): [number, number] {
  const k = c % 3;
  const t = c - k;
  return [indices[t + ((k + 1) % 3)]!, indices[t + ((k + 2) % 3)]!];
}

/** New normals for moved positions of the same mesh; writes shading.normals. */
export function updateNormals(
  shading: Shading,
  positions: ArrayLike<number>,
  indices: Uint32Array,
  scratch?: Float32Array,
): void {
  const faces = scratch?.length === indices.length ? scratch : new Float32Array(indices.length);
  faceNormals(positions, indices, faces);
  shading.normals.fill(0);
  // Through the drawn vertices, so that each fan gathers its own faces only.
  accumulate(shading.indices, faces, shading.normals);
  toUnit(shading.normals);
}

/** Edges with one triangle only: a mesh without them is closed and can be capped when cut. */
export function isClosed(indices: Uint32Array, vertexCount: number): boolean {
  // Each directed edge must meet its opposite. Sums of hashes cancel exactly when they pair up.
  let a = 0;
  let b = 0;
  const hash = (v: number, w: number): number => {
    let h = Math.imul(v + 1, 0x9e3779b1) ^ Math.imul(w + 0x7f4a7c15, 0x85ebca6b);
    h = Math.imul(h ^ (h >>> 15), 0x2c1b3c6d);
    return h ^ (h >>> 13);
  };
  if (vertexCount === 0 || indices.length === 0) return false;
  for (let t = 0; t < indices.length; t += 3) {
    for (let k = 0; k < 3; ++k) {
      const v = indices[t + k]!;
      const w = indices[t + ((k + 1) % 3)]!;
      a = (a + hash(v, w)) | 0;
      b = (b + hash(w, v)) | 0;
    }
  }
  return a === b;
}

/** Of a closed mesh, in cubic units: positive where its triangles look outwards. */
export function signedVolume(positions: ArrayLike<number>, indices: Uint32Array): number {
  let sum = 0;
  for (let t = 0; t < indices.length; t += 3) {
    const a = 3 * indices[t]!;
    const b = 3 * indices[t + 1]!;
    const c = 3 * indices[t + 2]!;
    sum +=
      positions[a]! * (positions[b + 1]! * positions[c + 2]! - positions[b + 2]! * positions[c + 1]!) +
      positions[a + 1]! * (positions[b + 2]! * positions[c]! - positions[b]! * positions[c + 2]!) +
      positions[a + 2]! * (positions[b]! * positions[c + 1]! - positions[b + 1]! * positions[c]!);
  }
  return sum / 6;
}
