// SPDX-License-Identifier: GPL-3.0-or-later
// Stands in for the core while there is no WASM build: the contract on simple shapes, depths merely scaled.
// For development only; a production build does not contain it.
import type { Backend, BlobSource, Output, Result, RunOptions } from '../backend';
import type { Catalog, Job, JsonObject } from '../contract';
import { cancelled, JobError } from '../contract';
import { parsePly } from '../ply';
import catalog from './catalog.json';
import type { Mesh } from './meshes';
import { readObj, sampleMesh, writePly, writeStl } from './meshes';

type Vector = [number, number, number];
const dot = (a: Vector, b: Vector) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a: Vector, b: Vector): Vector => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
const unit = (a: Vector): Vector => a.map((x) => x / Math.hypot(...a)) as Vector;

const output = (name: string, mediaType: string, data: Uint8Array<ArrayBuffer>): [string, Output] => [
  name,
  { name, mediaType, bytes: data.byteLength, read: () => Promise.resolve(data) },
];

export class MockBackend implements Backend {
  readonly kind = 'mock';
  readonly #blobs: BlobSource;
  constructor(blobs: BlobSource) {
    this.#blobs = blobs;
  }
  catalog = () => Promise.resolve(catalog as unknown as Catalog);
  dispose(): void {
    // Nothing is held.
  }

  async run(job: Job, options: RunOptions = {}): Promise<Result> {
    const mesh = await this.#mesh(job);
    if (job.operation !== 'relief') {
      const name = job.operation === 'import' ? 'model.ply' : 'simplified.ply';
      const report = {
        vertices: mesh.positions.length / 3,
        faces: mesh.indices.length / 3,
        components: 1,
        closed: true,
        repairs: ['Filled 2 holes.'],
        size_mm: [1, 1, 1],
        seconds_read: 0.01,
      };
      return { report, outputs: new Map([output(name, 'application/x-ply', writePly(mesh))]) };
    }
    if (job.outputs === undefined || job.outputs.includes('relief.stl')) await pretendToSolve(options);
    return mockRelief(mesh, job.parameters, job.outputs ?? ['relief.ply', 'relief.stl']);
  }

  async #mesh(job: Job): Promise<Mesh> {
    const input = job.inputs['mesh'];
    if (input === undefined)
      throw new JobError({ code: 'invalid_input', where: 'mesh', message: 'No model.' });
    if ('sample' in input) return sampleMesh(input.sample, input.vertices ?? 20000);
    const bytes = await this.#blobs.read(input.sha256);
    if (bytes[0] !== 0x70) {
      const mesh = readObj(bytes);
      if (mesh.indices.length > 0) return mesh;
      const message = 'The file holds no triangles. Export the model again as a mesh.';
      throw new JobError({ code: 'invalid_input', where: 'mesh', message });
    }
    const ply = parsePly(bytes);
    return { positions: new Float64Array(ply.positions), indices: ply.indices };
  }
}

async function pretendToSolve({ signal, onProgress }: RunOptions): Promise<void> {
  const stages = ['Finding the visible surface', 'Factorising', 'Fitting into the thickness', 'Writing'];
  for (let i = 0; i < 40; ++i) {
    if (signal?.aborted) throw cancelled();
    onProgress?.({
      fraction: i / 40,
      stage: stages[Math.floor(i / 10)] ?? '',
      seconds_left: (40 - i) * 0.05,
    });
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

function mockRelief(mesh: Mesh, parameters: JsonObject, wanted: readonly string[]): Result {
  const number = (name: string, fallback: number) => (parameters[name] as number | undefined) ?? fallback;
  const [width, thickness, plate] = [
    number('width_mm', 120),
    number('thickness_mm', 5),
    number('plate_mm', 3),
  ];
  const forward = unit((parameters['direction'] as Vector | undefined) ?? [0, 0, -1]);
  const right = unit(cross(forward, (parameters['up'] as Vector | undefined) ?? [0, 1, 0]));
  const up = cross(right, forward);
  const axes = [right, up, forward];
  const [low, high] = [[1e9, 1e9, 1e9] as Vector, [-1e9, -1e9, -1e9] as Vector];
  const vertices = mesh.positions.length / 3;
  const seen = new Float64Array(mesh.positions.length);
  for (let i = 0; i < vertices; ++i)
    axes.forEach((axis, k) => {
      const p: Vector = [
        mesh.positions[3 * i] ?? 0,
        mesh.positions[3 * i + 1] ?? 0,
        mesh.positions[3 * i + 2] ?? 0,
      ];
      const value = dot(p, axis);
      seen[3 * i + k] = value;
      low[k as 0] = Math.min(low[k as 0], value);
      high[k as 0] = Math.max(high[k as 0], value);
    });
  const scale = width / (high[0] - low[0]);
  const middle = scale * ((low[2] + high[2]) / 2);
  const positions = new Float64Array(mesh.positions.length);
  const error = new Float64Array(vertices);
  for (let i = 0; i < vertices; ++i) {
    const depth = ((seen[3 * i + 2] ?? 0) - high[2]) / (high[2] - low[2]);
    const local = [scale * (seen[3 * i] ?? 0), scale * (seen[3 * i + 1] ?? 0), middle + thickness * depth];
    for (let k = 0; k < 3; ++k)
      positions[3 * i + k] = axes.reduce((sum, axis, m) => sum + (axis[k as 0] ?? 0) * (local[m] ?? 0), 0);
    error[i] = 75 * Math.abs(depth);
  }
  const centre = axes[0]?.map(
    (_, k) =>
      (axes[0]?.[k] ?? 0) * scale * ((low[0] + high[0]) / 2) +
      (axes[1]?.[k] ?? 0) * scale * ((low[1] + high[1]) / 2) +
      (axes[2]?.[k] ?? 0) * middle,
  ) as Vector;
  const report = {
    vertices,
    faces: mesh.indices.length / 3,
    scale_mm_per_unit: scale,
    plate_centre_mm: centre,
    direction: forward,
    right,
    up,
    distance_mm: parameters['projection'] === 'orthographic' ? null : 340,
    size_mm: [width, scale * (high[1] - low[1]), thickness + plate],
    watertight: true,
    normal_error_mean_deg: 24 + 20 / thickness,
    normal_error_linear_mean_deg: 35 + 20 / thickness,
    normal_error_mean_deg_image: 24,
    seconds_solve: 0.4,
    seconds_setup: 0.2,
    repairs: [],
  };
  const relief: Mesh = { positions, indices: mesh.indices };
  const outputs = new Map<string, Output>();
  if (wanted.includes('relief.ply'))
    outputs.set(...output('relief.ply', 'application/x-ply', writePly(relief, { normal_error_deg: error })));
  if (wanted.includes('relief.stl')) outputs.set(...output('relief.stl', 'model/stl', writeStl(relief)));
  return { report, outputs };
}
