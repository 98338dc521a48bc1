// SPDX-License-Identifier: GPL-3.0-or-later
// From what was opened to a job that can be looked at and sent.
import type { Backend } from '../../jobs/backend';
import type { JsonObject, Report } from '../../jobs/contract';
import type { ToolPath } from '../../machines/toolpath';
import { toolPathOf, toolPathOfGcode } from '../../machines/toolpath_reader';
import type { BlobStore } from '../../project/blob_store';
import type { CraftResult } from '../common/craft_document';
import { bytesOf } from '../common/import_model';
import { sentences } from '../common/report';
import type { FileWork, Work } from './machines_document';
import { operationFor } from './machines_document';

/** A job that is ready to be looked at, and to be sent unless it does not fit. */
export interface Plan {
  /** Names the work and the parameters it was made with. */
  readonly key: string;
  readonly report: Report;
  readonly toolPath: ToolPath;
  readonly job: Uint8Array<ArrayBuffer> | null;
  readonly misfits: readonly string[];
}

export interface PlanRequest {
  readonly work: Work;
  readonly parameters: JsonObject;
}

export const sourceOf = (work: Work): string => `${work.kind} ${work.kind === 'test' ? '' : work.file.blob}`;
export const keyOf = ({ work, parameters }: PlanRequest): string =>
  `${sourceOf(work)} ${JSON.stringify(parameters)}`;

/** By `laser-job` or `test-grid`, quick enough to be made at every change. */
export async function planOfLaser(
  backend: Backend,
  request: PlanRequest,
  format: string,
  signal: AbortSignal,
): Promise<Plan> {
  const { work, parameters } = request;
  const inputs: Record<string, { sha256: string; file_name: string }> =
    work.kind === 'test' ? {} : { drawing: { sha256: work.file.blob, file_name: work.file_name } };
  const result = await backend.run(
    { operation: operationFor(work), parameters, inputs, outputs: [format, 'toolpath.json'] },
    { signal },
  );
  const toolPath = await toolPathOf(await bytesOf(result, 'toolpath.json'));
  const job = result.outputs.has(format) ? await bytesOf(result, format) : null;
  const misfits = sentences(result.report, 'misfits');
  return { key: keyOf(request), report: result.report, toolPath, job, misfits };
}

/** A file of G-code is sent as it is. */
export async function planOfJob(
  blobs: BlobStore,
  request: PlanRequest & { readonly work: FileWork },
  bed_mm: readonly [number, number],
  power_max_s: number,
): Promise<Plan> {
  const job = await blobs.read(request.work.file.blob);
  const toolPath = await toolPathOfGcode(job, bed_mm, power_max_s);
  return { key: keyOf(request), report: {}, toolPath, job, misfits: [] };
}

/** What a `mill-job` has made. */
export async function planOfResult(
  blobs: BlobStore,
  request: PlanRequest,
  { outputs, report }: CraftResult,
): Promise<Plan> {
  const [path, file] = [outputs['toolpath.json'], outputs['job.gcode']];
  const toolPath = await toolPathOf(await blobs.read(path?.blob ?? ''));
  const job = file ? await blobs.read(file.blob) : null;
  return { key: keyOf(request), report, toolPath, job, misfits: sentences(report, 'misfits') };
}
