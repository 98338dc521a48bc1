// SPDX-License-Identifier: GPL-3.0-or-later
// Full solves: in the native worker while it answers, else in the browser; found again after a reload.
import { untracked } from '@preact/signals';
import type { Backend, Result, RunOptions } from '../../jobs/backend';
import type { Job, JsonObject } from '../../jobs/contract';
import { findOperation, JobError } from '../../jobs/contract';
import type { BlobReference } from '../../project/document';
import type { RoomDocument, Subject } from './craft_document';
import { requestKey } from './craft_document';
import { remember } from './estimate';
import { bytesOf } from './import_model';
import type { RoomSession } from './room_session';
import { readyWorker } from './services';

function jobOf<D extends RoomDocument>(
  session: RoomSession<D>,
  subject: Subject,
  outputs: readonly string[],
): Job {
  const { operationName } = session;
  const declared = declaredOutputs(session);
  return {
    operation: operationName,
    parameters: session.asked.value,
    inputs: subject.inputs,
    outputs: outputs.filter((name) => declared.includes(name)),
  };
}

function declaredOutputs<D extends RoomDocument>({ services, operationName }: RoomSession<D>): string[] {
  const catalog = services.catalog.value;
  const operation = catalog && findOperation(catalog, operationName);
  return operation?.outputs.map(({ name }) => name) ?? [];
}

export async function solveInFull<D extends RoomDocument>(session: RoomSession<D>): Promise<void> {
  const subject = session.subject.value;
  if (subject === null || session.result.value !== null) return;
  const { services } = session;
  const parameters = session.asked.value;
  const worker = readyWorker(services);
  const backend = worker ?? services.browser;
  const job = jobOf(session, subject, worker ? declaredOutputs(session) : session.wantedOutputs);
  const mesh = subject.key;
  await solveWith(session, backend, mesh, parameters, (options) =>
    backend.run(job, {
      ...options,
      onAccepted: (id) => services.projects.do(session.commands.setPending({ job: id, mesh, parameters })),
    }),
  );
}

/** A solve that was still running in the worker when the page was closed is waited for again. */
export function resumePending<D extends RoomDocument>(session: RoomSession<D>): void {
  const worker = readyWorker(session.services);
  const { pending } = session.document.value;
  if (pending === null || !worker?.resume) return;
  const resume = worker.resume.bind(worker);
  untracked(() => {
    if (session.activity.value.kind !== 'idle') return;
    const { job, mesh, parameters } = pending;
    void solveWith(session, worker, mesh, parameters, (options) => resume(job, options));
  });
}

async function solveWith<D extends RoomDocument>(
  session: RoomSession<D>,
  backend: Backend,
  mesh: string,
  parameters: JsonObject,
  run: (options: RunOptions) => Promise<Result>,
): Promise<void> {
  const { commands } = session;
  const { projects } = session.services;
  session.cancelPreview();
  const start = performance.now();
  await session.busy(
    'solving',
    backend.kind,
    async (options) => {
      session.solvingFor = requestKey(mesh, parameters);
      const done = await run(options);
      const seconds = (performance.now() - start) / 1000;
      const outputs: Record<string, BlobReference> = {};
      for (const output of done.outputs.values())
        if (session.wantedOutputs.includes(output.name))
          outputs[output.name] = await session.keep(await output.read(), output.mediaType);
      const measured = session.measured(done.report);
      if (measured) remember(commands.craft, backend.kind, measured);
      const { pending } = session.document.value;
      const made = {
        id: crypto.randomUUID(),
        made_unix_s: Math.round(Date.now() / 1000),
        backend: backend.kind,
        seconds,
        mesh,
        parameters,
        report: done.report,
        outputs,
        ...(backend.kind === 'native' && pending ? { job: pending.job } : {}),
      };
      projects.do(commands.addResult(made));
    },
    (error) => {
      if (error.code !== 'unreachable') projects.do(commands.setPending(null));
      session.report(error, session.failedTitle);
    },
  );
  session.solvingFor = null;
  if (session.document.value.pending && backend.kind === 'native' && !session.result.value)
    projects.do(commands.setPending(null)); // cancelled
}

/** The bytes of an output of the current result: kept, still in the worker, or made now. */
export async function outputOf<D extends RoomDocument>(
  session: RoomSession<D>,
  name: string,
  label: string,
): Promise<Uint8Array<ArrayBuffer> | null> {
  const result = session.result.value;
  const subject = session.subject.value;
  if (result === null || subject === null) return null;
  const { blobs } = session.services.projects;
  const kept = result.outputs[name];
  if (kept && (await blobs.has(kept.blob))) return await blobs.read(kept.blob);
  return await session.busy(
    'exporting',
    label,
    async (options) => {
      const worker = readyWorker(session.services);
      const backend = worker ?? session.services.browser;
      const old =
        result.job && worker?.resume ? await worker.resume(result.job, options).catch(() => null) : null;
      const done = old?.outputs.has(name) ? old : await backend.run(jobOf(session, subject, [name]), options);
      const bytes = await bytesOf(done, name);
      const mediaType = done.outputs.get(name)?.mediaType;
      if (mediaType === undefined)
        throw new JobError({ code: 'internal', where: name, message: 'No output.' });
      const reference = await session.keep(bytes, mediaType);
      session.services.projects.do(
        session.commands.amendResult(result.id, (before) => ({
          ...before,
          outputs: { ...before.outputs, [name]: reference },
        })),
      );
      return bytes;
    },
    (error) => session.report(error, `Could not make the ${label} file`),
  );
}
