// SPDX-License-Identifier: GPL-3.0-or-later
// From a file or a sample to a repaired model with its small stand-in for previews.
import type { Backend, Result, RunOptions } from '../../jobs/backend';
import type { Job, JobInput, Report } from '../../jobs/contract';
import { asJobError, JobError } from '../../jobs/contract';
import { onlyPicture } from '../../jobs/glb';
import { plyPictures } from '../../jobs/ply';
import type { BlobStore } from '../../project/blob_store';
import type { BlobReference } from '../../project/document';
import { storageSentence } from '../../project/storage';
import { toast } from '../../ui';
import type { CraftModel, GroupSource, SingleSource, Source } from './craft_document';
import { meshInput } from './craft_document';
import { figure } from './report';

/** Enough for a faithful picture, few enough to re-solve while a slider moves. */
const previewVertices = 8000;

const ply = 'application/x-ply';

export async function importModel(
  backend: Backend,
  blobs: BlobStore,
  source: Source,
  options: RunOptions,
): Promise<CraftModel> {
  const job =
    source.kind === 'group'
      ? await combineJob(blobs, source)
      : { operation: 'import', parameters: {}, inputs: { mesh: inputOf(source) }, outputs: ['model.ply'] };
  const { report, outputs } = await backend.run(job, options);
  const bytes = await bytesOf({ report, outputs }, 'model.ply');
  const mesh = await keep(blobs, bytes, ply);
  const picture =
    source.kind === 'group' ? null : await ownPicture(backend, blobs, source, bytes, job, options);
  const model = { source, mesh, report, ...(picture ? { picture } : {}) };
  if ((figure(report, 'vertices') ?? 0) <= previewVertices) return { ...model, preview: mesh };
  const simplify = {
    operation: 'simplify',
    parameters: { target_vertices: previewVertices },
    inputs: { mesh: meshInput(mesh, 'model.ply') },
    outputs: ['simplified.ply'],
  };
  const simplified = await backend.run(simplify, options);
  const preview = await keep(blobs, await bytesOf(simplified, 'simplified.ply'), ply);
  return { ...model, preview };
}

const inputOf = (source: SingleSource): JobInput =>
  source.kind === 'sample'
    ? { sample: source.sample }
    : { sha256: source.file.blob, file_name: source.file_name };

/** What `import` says of a model, its size above all. */
export async function importedReport(
  backend: Backend,
  source: SingleSource,
  options: RunOptions,
): Promise<Report> {
  const job = { operation: 'import', parameters: {}, inputs: { mesh: inputOf(source) }, outputs: [] };
  return (await backend.run(job, options)).report;
}

/** The scene of several models as the operation `combine` reads it; each file is given once. */
async function combineJob(blobs: BlobStore, { models }: GroupSource): Promise<Job> {
  const files = [
    ...new Map(
      models.flatMap(({ source }) => (source.kind === 'file' ? [[source.file.blob, source] as const] : [])),
    ),
  ];
  const scene = models.map(({ source, ...placed }) => ({
    ...placed,
    ...(source.kind === 'sample'
      ? { sample: source.sample }
      : { model: files.findIndex(([blob]) => blob === source.file.blob) + 1 }),
  }));
  const bytes = new TextEncoder().encode(JSON.stringify({ models: scene }));
  const inputs: Record<string, JobInput> = {
    scene: { sha256: await blobs.hold(bytes), file_name: 'scene.json' },
  };
  for (const [i, [, source]] of files.entries())
    inputs[i === 0 ? 'model' : `model_${i + 1}`] = inputOf(source);
  return { operation: 'combine', parameters: {}, inputs, outputs: ['model.ply'] };
}

const isPicture = (file_name: string): boolean => /\.(png|jpe?g)$/i.test(file_name);

/** The picture that came with the file, else the one inside it. The mesh as PLY only names it, GLB holds it. A model
 *  opens without its picture where that cannot be read. */
async function ownPicture(
  backend: Backend,
  blobs: BlobStore,
  source: Source,
  mesh: Uint8Array,
  job: Job,
  options: RunOptions,
): Promise<BlobReference | null> {
  try {
    const { placed, names } = plyPictures(mesh);
    if (!placed) return null;
    const beside = source.kind === 'file' ? (source.companions ?? []) : [];
    const companion = beside.find(({ file_name }) => isPicture(file_name));
    if (companion) return companion.file;
    if (names.length !== 1) return null;
    const glb = await backend.run({ ...job, outputs: ['model.glb'] }, options);
    const found = onlyPicture(await bytesOf(glb, 'model.glb'));
    return found && (await keep(blobs, found.picture, found.media_type));
  } catch (thrown) {
    if (asJobError(thrown).code === 'cancelled') throw thrown;
    return null;
  }
}

export async function bytesOf(result: Result, name: string): Promise<Uint8Array<ArrayBuffer>> {
  const output = result.outputs.get(name);
  if (output === undefined)
    throw new JobError({
      code: 'internal',
      where: name,
      message: `The solver did not make the file ${name}.`,
    });
  return await output.read();
}

/** Keeps bytes with the project; a browser without room is said, and does not stop the work. */
export async function keep(
  blobs: BlobStore,
  bytes: Uint8Array<ArrayBuffer>,
  media_type: string,
): Promise<BlobReference> {
  let blob: string;
  try {
    blob = await blobs.put(bytes);
  } catch (thrown) {
    toast(storageSentence(thrown), true);
    blob = await blobs.hold(bytes);
  }
  return { blob, bytes: bytes.byteLength, media_type };
}
