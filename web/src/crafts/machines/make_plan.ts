// SPDX-License-Identifier: GPL-3.0-or-later
// From what was opened to a job that can be looked at and sent.
import type { Backend } from '../../jobs/backend';
import type { JsonObject, Report } from '../../jobs/contract';
import type { ToolPath } from '../../machines/toolpath';
import { toolPathOf, toolPathOfGcode } from '../../machines/toolpath_reader';
import type { BlobStore } from '../../project/blob_store';
import type { CraftResult } from '../../shared/session/craft_document';
import { bytesOf } from '../../shared/session/import_model';
import { sentences, vectorOf } from '../../shared/session/report';
import type { FileWork, Work } from './machines_document';
import { operationFor } from './machines_document';

/** One file for the machine. */
interface PlannedJob {
  /** "rough" or "finish" where each tool has a job of its own; "" for the only one. */
  readonly stage: string;
  readonly bytes: Uint8Array<ArrayBuffer>;
}

/** A job that is ready to be looked at, and to be sent unless it does not fit. */
export interface Plan {
  /** Names the work and the parameters it was made with. */
  readonly key: string;
  readonly report: Report;
  readonly toolPath: ToolPath;
  /** In the order in which they run; none where it does not fit. */
  readonly jobs: readonly PlannedJob[];
  readonly misfits: readonly string[];
  /** The surface that a mill leaves; not there for a laser, and for jobs made before it was kept. */
  readonly carved?: CarvedSurface;
}

export interface CarvedSurface {
  /** The PLY's hash. */
  readonly blob: string;
  /** From the file's coordinates to those of the tool path. */
  readonly offset_mm: readonly [number, number, number];
}

/** What `mill-job` puts below the lowest place, so that the carving is a solid. */
const carvedPlate_mm = 2;

/** In the file the plate's lower left corner is at zero; in the tool path the stock's top is at height zero. */
export function carvedOf(
  { outputs, report }: Pick<CraftResult, 'outputs' | 'report'>,
  parameters: JsonObject,
): { readonly carved?: CarvedSurface } {
  const blob = outputs['carved.ply']?.blob;
  const depth_mm = vectorOf(report, 'size_mm')?.[2];
  if (blob === undefined || depth_mm === undefined) return {};
  const value = (name: string) => Number(parameters[name] ?? 0);
  const top_mm = carvedPlate_mm + depth_mm + value('stock_over_mm');
  return { carved: { blob, offset_mm: [value('x_mm'), value('y_mm'), -top_mm] } };
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
  const jobs = result.outputs.has(format) ? [{ stage: '', bytes: await bytesOf(result, format) }] : [];
  const misfits = sentences(result.report, 'misfits');
  return { key: keyOf(request), report: result.report, toolPath, jobs, misfits };
}

/** A file of G-code is sent as it is. */
export async function planOfJob(
  blobs: BlobStore,
  request: PlanRequest & { readonly work: FileWork },
  bed_mm: readonly [number, number],
  power_max_s: number,
): Promise<Plan> {
  const bytes = await blobs.read(request.work.file.blob);
  const toolPath = await toolPathOfGcode(bytes, bed_mm, power_max_s);
  return { key: keyOf(request), report: {}, toolPath, jobs: [{ stage: '', bytes }], misfits: [] };
}

/** What a `mill-job` has made. */
export async function planOfResult(
  blobs: BlobStore,
  request: PlanRequest,
  result: CraftResult,
  /** With defaults filled in. */
  parameters: JsonObject,
): Promise<Plan> {
  const { outputs, report } = result;
  const toolPath = await toolPathOf(await blobs.read(outputs['toolpath.json']?.blob ?? ''));
  const files = toolPath.stages ?? [{ name: '', file: 'job.gcode' }];
  const jobs = await Promise.all(
    files.flatMap(({ name, file }) => {
      const made = outputs[file];
      return made ? [blobs.read(made.blob).then((bytes) => ({ stage: name, bytes }))] : [];
    }),
  );
  return {
    key: keyOf(request),
    report,
    toolPath,
    jobs,
    misfits: sentences(report, 'misfits'),
    ...carvedOf(result, parameters),
  };
}
