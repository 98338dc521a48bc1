// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of our own samples, drawn by the view at the first visit and kept. Drawn one after the other,
// and only while nothing else is wanted of the solver.
import type { Services } from '../crafts/common/services';
import type { Sample } from '../jobs/contract';
import { readPly } from '../jobs/mesh_reader';
import { originalData, plateOf, reliefData } from '../crafts/relief/meshes';
import { renderThumbnail } from '../view';
import { pictures } from './pictures';

const cacheName = 'pictures';
const pictureVertices = 6000;

async function kept(key: string, draw: () => Promise<Blob>): Promise<Blob> {
  const cache = await caches.open(cacheName).catch(() => null);
  const url = new URL(`pictures/${key}`, location.href).href;
  const found = await cache?.match(url);
  if (found) return await found.blob();
  const blob = await draw();
  await cache?.put(url, new Response(blob)).catch(() => undefined);
  return blob;
}

async function drawSample(services: Services, { name }: Sample): Promise<Blob> {
  const inputs = { mesh: { sample: name, vertices: pictureVertices } };
  const job = { operation: 'import', parameters: {}, inputs, outputs: ['model.ply'] };
  const output = (await services.browser.run(job)).outputs.get('model.ply');
  if (output === undefined) throw new Error('No model.');
  const mesh = await readPly(await output.read());
  return await renderThumbnail(
    originalData(mesh, 1),
    { widthPx: 264, heightPx: 198 },
    { transparent: true, ground: true },
  );
}

async function drawRelief(services: Services, { name }: Sample): Promise<Blob> {
  const inputs = { mesh: { sample: name, vertices: pictureVertices } };
  const job = { operation: 'relief', parameters: {}, inputs, outputs: ['relief.ply'] };
  const result = await services.browser.run(job);
  const output = result.outputs.get('relief.ply');
  if (output === undefined) throw new Error('No relief.');
  const mesh = await readPly(await output.read());
  const plate = plateOf(result.report, thicknessOf(services));
  const options = {
    transparent: true,
    plate,
    viewpoint: { direction: [-0.45, -0.25, -1], up: [0, 1, 0] },
  } as const;
  return await renderThumbnail(reliefData(mesh), { widthPx: 560, heightPx: 352 }, options);
}

function thicknessOf(services: Services): number {
  const relief = services.catalog.value?.operations.find(({ name }) => name === 'relief');
  return Number(relief?.parameters.properties['thickness_mm']?.default ?? 0);
}

let running = false;

export async function drawPictures(services: Services, busy: () => boolean): Promise<void> {
  const catalog = services.catalog.value;
  if (running || catalog === null) return;
  running = true;
  const [first] = catalog.samples;
  const jobs = catalog.samples.map((sample) => [sample.name, () => drawSample(services, sample)] as const);
  if (first) jobs.unshift(['craft:relief', () => drawRelief(services, first)]);
  for (const [name, draw] of jobs) {
    if (pictures.value[name]) continue;
    while (busy()) await new Promise((resolve) => setTimeout(resolve, 300));
    try {
      const blob = await kept(`${catalog.version}/${name}`, draw);
      pictures.value = { ...pictures.value, [name]: URL.createObjectURL(blob) };
    } catch {
      // A picture less; the sample can still be opened.
    }
  }
  running = false;
}
