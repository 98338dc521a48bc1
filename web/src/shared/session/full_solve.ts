// SPDX-License-Identifier: GPL-3.0-or-later
// Full solves: in the native worker while it answers, else in the browser; found again after a reload.
import { untracked } from '@preact/signals';
import type { Backend, Result, RunOptions } from '../../jobs/backend';
import { leaving } from '../../jobs/backend';
import type { Job } from '../../jobs/contract';
import { asJobError, findOperation, JobError } from '../../jobs/contract';
import type { BlobReference } from '../../project/document';
import type { RoomDocument, SolveRequest, Subject } from './craft_document';
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

/** Nothing happens while something runs: a key pressed once more must not throw away how far it has come. */
export async function solveInFull<D extends RoomDocument>(session: RoomSession<D>): Promise<void> {
  const subject = session.subject.value;
  if (subject === null || session.result.value !== null || session.activity.value.kind !== 'idle') return;
  const { services } = session;
  const parameters = session.asked.value;
  const worker = readyWorker(services);
  const backend = worker ?? services.browser;
  const job = jobOf(session, subject, worker ? declaredOutputs(session) : session.wantedOutputs);
  await solveWith(session, {
    backend,
    mesh: subject.key,
    parameters,
    job: null,
    run: (options) => backend.run(job, options),
  });
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
    void solveWith(session, {
      backend: worker,
      mesh,
      parameters,
      job,
      run: (options) => resume(job, options),
    });
  });
}

interface Solve extends SolveRequest {
  readonly backend: Backend;
  /** The worker's name for it; null until it has one. */
  readonly job: string | null;
  readonly run: (options: RunOptions) => Promise<Result>;
}

async function solveWith<D extends RoomDocument>(session: RoomSession<D>, solve: Solve): Promise<void> {
  const { commands } = session;
  const { projects } = session.services;
  const { backend, mesh, parameters, run } = solve;
  const own = requestKey(mesh, parameters);
  let { job } = solve;
  session.cancelPreview();
  const start = performance.now();
  await session.busy(
    'solving',
    backend.kind,
    async (options) => {
      session.solvingFor = own;
      const onAccepted = (id: string) => {
        job = id;
        options.do(commands.setPending({ job: id, mesh, parameters }));
      };
      try {
        const done = await run({ ...options, onAccepted });
        const seconds = (performance.now() - start) / 1000;
        const outputs: Record<string, BlobReference> = {};
        for (const output of done.outputs.values())
          if (session.wantedOutputs.includes(output.name))
            outputs[output.name] = await session.keep(await output.read(), output.mediaType);
        const made = {
          id: crypto.randomUUID(),
          made_unix_s: Math.round(Date.now() / 1000),
          backend: backend.kind,
          seconds,
          mesh,
          parameters,
          report: done.report,
          outputs,
          ...(job === null ? {} : { job }),
        };
        options.do(commands.addResult(made));
        const measured = session.measured(done.report);
        if (measured) remember(commands.craft, backend.kind, measured);
      } catch (thrown) {
        // What goes on in the worker, or has ended there unseen, is found again by what is pending.
        const goesOn = options.signal.reason === leaving || asJobError(thrown).code === 'unreachable';
        // Compared by name: another project that is open by now may have its own.
        const isPending = session.document.value.pending?.job === job;
        if (!goesOn && isPending) projects.do(commands.setPending(null));
        throw thrown;
      }
    },
    (error) => session.reportAsked(error, session.failedTitle),
  );
  if (session.solvingFor === own) session.solvingFor = null;
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
      options.do(
        session.commands.amendResult(result.id, (before) => ({
          ...before,
          outputs: { ...before.outputs, [name]: reference },
        })),
      );
      return bytes;
    },
    (error) => session.reportAsked(error, `Could not make the ${label} file`),
  );
}
