// SPDX-License-Identifier: GPL-3.0-or-later
// The native worker on this machine: docs/job_contract.md, "In the worker". Jobs outlive the page and
// are found again; a line that breaks is mended and every job waited for is asked about anew.
import type { Backend, BlobSource, Output, Result, RunOptions } from './backend';
import { leaving } from './backend';
import type { Catalog, ErrorMessage, Job, OutputDescription, Progress, Report } from './contract';
import { asJobError, cancelled, JobError } from './contract';
import type { ConnectionState, SocketMessage } from './native_connection';
import { isRefusal, NativeConnection } from './native_connection';

interface JobRecord {
  readonly id: string;
  readonly state: 'queued' | 'running' | 'done' | 'failed' | 'cancelled';
  readonly progress?: Progress;
  readonly result?: {
    readonly report: Report;
    readonly outputs: Readonly<Record<string, OutputDescription>>;
  };
  readonly error?: ErrorMessage;
}

interface Waiting {
  readonly options: RunOptions;
  resolve(result: Result): void;
  reject(error: JobError): void;
}

export interface NativeBackendOptions {
  readonly origin: string;
  readonly token: string;
  readonly blobs: BlobSource;
  readonly onState?: (state: ConnectionState) => void;
  readonly fetch?: typeof fetch;
  readonly WebSocket?: typeof WebSocket;
  readonly pace?: number;
}

export class NativeBackend implements Backend {
  readonly kind = 'native';
  readonly connection: NativeConnection;
  readonly #options: NativeBackendOptions;
  readonly #waiting = new Map<string, Waiting>();
  readonly #knownBlobs = new Set<string>();
  #catalog: Promise<Catalog> | null = null;

  constructor(options: NativeBackendOptions) {
    this.#options = options;
    this.connection = new NativeConnection({
      ...options,
      onState: (state) => this.#stateChanged(state),
      onMessage: (message) => this.#receive(message),
    });
    this.connection.connect();
  }

  async catalog(): Promise<Catalog> {
    this.#catalog ??= this.connection.json<Catalog>('catalog');
    try {
      return await this.#catalog;
    } catch (thrown) {
      this.#catalog = null;
      throw thrown;
    }
  }

  async run(job: Job, options: RunOptions = {}): Promise<Result> {
    const signal = options.signal ?? null;
    try {
      for (const input of Object.values(job.inputs))
        if ('sha256' in input) await this.#putBlob(input.sha256, signal);
      const { id } = await this.connection.json<{ id: string }>('jobs', {
        method: 'POST',
        headers: { 'Content-Type': 'application/json' },
        body: JSON.stringify(job),
        signal,
      });
      if (signal?.aborted) {
        this.#cancel(id); // nobody was told its name, so nobody could find it again
        throw cancelled();
      }
      options.onAccepted?.(id);
      return await this.resume(id, options);
    } catch (thrown) {
      if (signal?.aborted) throw cancelled();
      throw asJobError(thrown);
    }
  }

  resume(id: string, options: RunOptions = {}): Promise<Result> {
    return new Promise<Result>((resolve, reject) => {
      const cancel = () => {
        if (options.signal?.reason === leaving) this.#waiting.get(id)?.reject(cancelled());
        else this.#cancel(id);
      };
      const settle = () => {
        this.#waiting.delete(id);
        options.signal?.removeEventListener('abort', cancel);
      };
      this.#waiting.set(id, {
        options,
        resolve: (result) => {
          settle();
          resolve(result);
        },
        reject: (error) => {
          settle();
          reject(error);
        },
      });
      options.signal?.addEventListener('abort', cancel);
      if (options.signal?.aborted) cancel();
      void this.#ask(id); // it may have finished before the socket was listening
    });
  }

  dispose(): void {
    this.connection.close();
    for (const waiting of [...this.#waiting.values()]) waiting.reject(cancelled());
  }

  async #putBlob(sha256: string, signal: AbortSignal | null): Promise<void> {
    if (this.#knownBlobs.has(sha256)) return;
    const path = `blobs/${sha256}`;
    // Not asked for first: "no" would stand as an error in the console, and on this machine's own line
    // sending a mesh once more after a reload costs less than it sounds.
    const body = await this.#options.blobs.read(sha256);
    await this.connection.requestOk(path, { method: 'PUT', body, signal });
    this.#knownBlobs.add(sha256);
  }

  #cancel(id: string): void {
    if (!this.connection.send({ type: 'cancel', id }))
      void this.connection.request(`jobs/${id}/cancel`, { method: 'POST' }).catch(() => undefined);
    // The person is not kept waiting for the worker's answer.
    this.#waiting.get(id)?.reject(cancelled());
  }

  #stateChanged(state: ConnectionState): void {
    if (state.state === 'ready') {
      this.#knownBlobs.clear(); // it may be another worker, with an empty store
      for (const id of this.#waiting.keys()) void this.#ask(id);
    }
    this.#options.onState?.(state);
    // It does not ask again by itself, so nobody may be kept waiting; after the state, so that nobody asks this worker once more.
    if (state.state === 'refused') {
      const refusal = new JobError({ code: 'unreachable', where: 'token', message: state.message });
      for (const waiting of [...this.#waiting.values()]) waiting.reject(refusal);
    }
  }

  #receive(message: SocketMessage): void {
    const waiting = this.#waiting.get(message.id);
    if (waiting === undefined) return;
    if (message.type === 'finished') void this.#ask(message.id);
    else waiting.options.onProgress?.('progress' in message ? message.progress : message);
  }

  async #ask(id: string): Promise<void> {
    try {
      const record = await this.connection.json<JobRecord>(`jobs/${encodeURIComponent(id)}`);
      const waiting = this.#waiting.get(id);
      if (waiting === undefined) return;
      if (record.progress) waiting.options.onProgress?.(record.progress);
      if (record.state === 'done' && record.result) waiting.resolve(this.#result(id, record.result));
      else if (record.state === 'cancelled') waiting.reject(cancelled());
      else if (record.error) waiting.reject(new JobError(record.error));
    } catch (thrown) {
      const error = asJobError(thrown);
      if (error.code === 'unreachable' && !isRefusal(error)) return; // asked again when the line is back
      this.#waiting.get(id)?.reject(error);
    }
  }

  #result(id: string, result: NonNullable<JobRecord['result']>): Result {
    const outputs = new Map<string, Output>();
    for (const [name, { media_type, bytes }] of Object.entries(result.outputs)) {
      const path = `jobs/${encodeURIComponent(id)}/outputs/${encodeURIComponent(name)}`;
      const read = async () => new Uint8Array(await (await this.connection.requestOk(path)).arrayBuffer());
      outputs.set(name, { name, mediaType: media_type, bytes, read });
    }
    return { report: result.report, outputs };
  }
}
