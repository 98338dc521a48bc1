// SPDX-License-Identifier: GPL-3.0-or-later
// Draws the pictures of the start screen, in a browser, for scripts/draw_pictures.js to keep in public/.
// Not part of the page: drawing a gallery at each first visit would take the solver's time.
import { originalData } from '../../src/shared/panels/shaded_mesh';
import { plateOf, reliefData } from '../../src/crafts/relief/meshes';
import { clampFrame, frameShadow } from '../../src/crafts/thermoform/clamp_frame';
import type { Job, JsonObject, Report, Sample } from '../../src/jobs/contract';
import { findOperation } from '../../src/jobs/contract';
import { readPly } from '../../src/jobs/mesh_reader';
import { WasmBackend } from '../../src/jobs/wasm_backend';
import type { ColourMapping } from '../../src/view';
import { renderThumbnail } from '../../src/view';

const pictureVertices = 30_000;
const none = { read: () => Promise.reject(new Error('No inputs.')) };

/** WebP pictures as data URLs, by file name without its ending. */
export async function drawPictures(only?: string): Promise<Record<string, string>> {
  const backend = new WasmBackend({
    moduleUrl: new URL('/wasm/formwright.mjs', location.href).href,
    blobs: none,
  });
  const catalog = await backend.catalog();
  const run = async (job: Omit<Job, 'parameters'>, output: string, parameters: JsonObject = {}) => {
    const { report, outputs } = await backend.run({ ...job, parameters });
    const made = outputs.get(output);
    if (made === undefined) throw new Error(`No ${output}.`);
    return { report, mesh: await readPly(await made.read()) };
  };
  const input = ({ name, default_vertices }: Sample) => ({
    mesh: { sample: name, vertices: Math.min(default_vertices, pictureVertices) },
  });
  const pictures: Record<string, string> = {};
  for (const sample of catalog.samples) {
    if (only !== undefined && only !== sample.name) continue;
    const job = { operation: 'import', inputs: input(sample), outputs: ['model.ply'] };
    const { mesh } = await run(job, 'model.ply');
    const options = { transparent: true, ground: true, patient: true };
    const size = { widthPx: 396, heightPx: 297 };
    pictures[sample.name] = await webp(await renderThumbnail(originalData(mesh, 1), size, options));
  }
  const [first] = catalog.samples;
  if (first && (only === undefined || only === 'craft_relief')) {
    const job = { operation: 'relief', inputs: input(first), outputs: ['relief.ply'] };
    const { mesh, report } = await run(job, 'relief.ply');
    const thickness = findOperation(catalog, 'relief')?.parameters.properties['thickness_mm']?.default;
    const picture = await renderThumbnail(
      reliefData(mesh),
      { widthPx: 560, heightPx: 352 },
      {
        transparent: true,
        patient: true,
        plate: plateOf(report, Number(thickness)),
        viewpoint: { direction: [-0.45, -0.25, -1], up: [0, 1, 0] },
      },
    );
    pictures['craft_relief'] = await webp(picture);
  }
  if (only === undefined || only === 'craft_thermoform')
    pictures['craft_thermoform'] = await formedSheet(run);
  if (only === undefined || only === 'craft_evidence') pictures['craft_evidence'] = await hiddenFault(run);
  if (only === undefined || only === 'craft_zippable') pictures['craft_zippable'] = await ribbonHeart(run);
  return pictures;
}

type Run = (
  job: Omit<Job, 'parameters'>,
  output: string,
  parameters?: JsonObject,
) => Promise<{ report: Report; mesh: Awaited<ReturnType<typeof readPly>> }>;

/** The heart as its ribbon makes it, flat between rulings. */
async function ribbonHeart(run: Run): Promise<string> {
  const inputs = { mesh: { sample: 'heart' } };
  const job = { operation: 'zippable-design', inputs, outputs: ['formed.ply'] };
  const { mesh } = await run(job, 'formed.ply', { width_mm: 12 });
  // Flat triangles of one colour: corners apart, as cloth between two rulings is.
  const flat = new Float32Array(3 * mesh.indices.length);
  mesh.indices.forEach((vertex, i) => flat.set(mesh.positions.subarray(3 * vertex, 3 * vertex + 3), 3 * i));
  const cloth = [0x3e / 255, 0x7c / 255, 0x86 / 255];
  const picture = await renderThumbnail(
    {
      positions: flat,
      indices: mesh.indices.map((_, i) => i),
      colours: Float32Array.from(flat, (_, i) => cloth[i % 3] ?? 0),
    },
    { widthPx: 560, heightPx: 352 },
    {
      transparent: true,
      ground: true,
      patient: true,
      viewpoint: { direction: [-0.35, -0.3, -1], up: [0, 1, 0] },
    },
  );
  return await webp(picture);
}

/** The mountain under its sheet, coloured by thickness, in a clamp that shows little of its own. */
async function formedSheet(run: Run): Promise<string> {
  const inputs = { mould: { sample: 'mountain', vertices: pictureVertices } };
  const { mesh, report } = await run(
    { operation: 'thermoform-simulate', inputs, outputs: ['sheet.ply'] },
    'sheet.ply',
  );
  const thickest = (mesh.attributes['thickness_mm'] ?? new Float32Array(1)).reduce(
    (a, b) => Math.max(a, b),
    0,
  );
  return await inItsClamp(mesh, {
    attribute: 'thickness_mm',
    map: 'thickness',
    minimum: 0.9 * Number(report['thickness_min_mm'] ?? 0),
    maximum: thickest,
    unit: 'mm',
    label: 'Thickness',
  });
}

/** The pyramid under its sheet, coloured by how far a heater that is hot on one side moves each point. */
async function hiddenFault(run: Run): Promise<string> {
  const job = {
    operation: 'thermoform-simulate',
    inputs: { mould: { sample: 'pyramid' } },
    outputs: ['sheet.ply'],
  };
  const parameters = { triangles: 10_000 };
  const { mesh } = await run(job, 'sheet.ply', parameters);
  const moved = await run(job, 'sheet.ply', { ...parameters, heating_gradient_x: 0.4 });
  const [here, there] = [mesh.positions, moved.mesh.positions];
  const distance_mm = Float32Array.from({ length: here.length / 3 }, (_, i) =>
    Math.hypot(...[0, 1, 2].map((k) => (here[3 * i + k] ?? 0) - (there[3 * i + k] ?? 0))),
  );
  const maximum = distance_mm.reduce((a, b) => Math.max(a, b), 0);
  return await inItsClamp(
    { ...mesh, attributes: { distance_mm } },
    { attribute: 'distance_mm', map: 'error', minimum: 0, maximum, unit: 'mm', label: 'Distance' },
  );
}

async function inItsClamp(
  { positions, indices, attributes }: Awaited<ReturnType<typeof readPly>>,
  mapping: ColourMapping,
): Promise<string> {
  const high = positions.reduce((most, z, i) => (i % 3 === 2 ? Math.max(most, z) : most), 0);
  const side = (axis: number) =>
    2 * positions.reduce((most, x, i) => (i % 3 === axis ? Math.max(most, x) : most), 0);
  const clamp = { sheet_mm: [side(0), side(1)], opening_mm: [side(0), side(1)], height_mm: 1 } as const;
  const picture = await renderThumbnail(
    { positions, indices, attributes },
    { widthPx: 560, heightPx: 352 },
    {
      transparent: true,
      patient: true,
      plate: { ...frameShadow(clamp), mesh: clampFrame(clamp, high) },
      viewpoint: { direction: [0.2, 0.9, -0.8], up: [0, 0, 1] },
      mapping,
    },
  );
  return await webp(picture);
}

async function webp(png: Blob): Promise<string> {
  const image = await createImageBitmap(png);
  const canvas = document.createElement('canvas');
  canvas.width = image.width;
  canvas.height = image.height;
  canvas.getContext('2d')?.drawImage(image, 0, 0);
  return canvas.toDataURL('image/webp', 0.86);
}
