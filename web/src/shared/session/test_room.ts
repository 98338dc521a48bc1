// SPDX-License-Identifier: GPL-3.0-or-later
// A room for tests: a session on projects in memory, and backends that answer when the test says so.
import { computed, signal } from '@preact/signals';
import type { Backend, Result, RunOptions } from '../../jobs/backend';
import type { Catalog, Job, JobError, Report } from '../../jobs/contract';
import { cancelled, findOperation } from '../../jobs/contract';
import type { ConnectionState } from '../../jobs/native_connection';
import { BlobStore } from '../../project/blob_store';
import type { BlobReference } from '../../project/document';
import { ProjectStore } from '../../project/project_store';
import { MemoryStorage } from '../../project/storage';
import type { CraftDocument, CraftModel, CraftResult } from './craft_document';
import { CraftCommands, emptyCraft, sameRequest } from './craft_document';
import type { PreviewRequest, ShownWork } from './previews';
import { OpenedModel } from './opened_model';
import { Previews } from './previews';
import type { RoomWithProducts } from './products';
import { RoomSession } from './room_session';

export const testCatalog = (...names: readonly string[]): Catalog => ({
  version: '1',
  operations: names.map((name) => ({
    name,
    title: name,
    inputs: [],
    parameters: { properties: {} },
    outputs: [{ name: 'made.ply', media_type: 'application/x-ply', label: 'Made' }],
  })),
  samples: [],
  mesh_formats: [],
});

/** A job that was asked for, or the name of one that is waited for again. */
export interface HeldRun {
  readonly asked: Job | string;
  readonly options: RunOptions;
  finish(output?: string): void;
  fail(error: JobError): void;
}

export class HeldBackend implements Backend {
  readonly kind: Backend['kind'];
  readonly runs: HeldRun[] = [];
  /** What is ended comes to its end all the same, as a job does that was all but done. */
  deaf = false;
  dispose = () => undefined;

  constructor(kind: Backend['kind']) {
    this.kind = kind;
  }

  catalog = () => Promise.resolve(testCatalog());

  async run(job: Job, options: RunOptions = {}): Promise<Result> {
    if (this.kind === 'native') options.onAccepted?.(`job${this.runs.length}`);
    return await this.#hold(job, options);
  }

  async resume(id: string, options: RunOptions = {}): Promise<Result> {
    return await this.#hold(id, options);
  }

  #hold(asked: Job | string, options: RunOptions): Promise<Result> {
    return new Promise((resolve, reject) => {
      const data = new TextEncoder().encode('ply');
      const finish = (name = 'made.ply') => {
        const output = { name, mediaType: 'x', bytes: 3, read: () => Promise.resolve(data) };
        resolve({ report: {}, outputs: new Map([[name, output]]) });
      };
      this.runs.push({ asked, options, finish, fail: reject });
      options.signal?.addEventListener('abort', () => void (this.deaf || reject(cancelled())));
    });
  }
}

type TestDocument = CraftDocument & RoomWithProducts;
export const testCraft = new CraftCommands<TestDocument>('test', { ...emptyCraft, products: [] });

export class TestRoom extends RoomSession<TestDocument> {
  readonly operationName = 'test';
  readonly wantedOutputs = ['made.ply'];
  readonly failedTitle = 'Could not make it';
  readonly document = computed(() => testCraft.of(this.services.projects.document.value));
  readonly operation = computed(() => findOperation(testCatalog('test'), 'test') ?? null);
  readonly asked = computed(() => this.document.value.parameters);
  readonly model: OpenedModel<TestDocument> = new OpenedModel(this, {
    commands: testCraft,
    inputName: 'mesh',
    forgets: () => false,
  });
  readonly hasWork = this.model.isThere;
  readonly subject = this.model.subject;
  readonly result = this.unlessLost(
    computed(() => {
      const request = { mesh: this.subject.value?.key ?? '', parameters: this.asked.value };
      return this.document.value.results.find((made) => sameRequest(made, request)) ?? null;
    }),
  );
  readonly previews = new Previews<TestDocument, ShownWork>(this, {
    shownOutputs: this.wantedOutputs,
    failedTitle: 'Could not preview it',
    make: (request) => this.#makePreview(request),
    read: (result) => this.#readResult(result),
  });
  readonly shown = this.previews.shown;
  /** Why no preview is made, where none is. */
  refuses: JobError | null = null;
  readonly projects: ProjectStore;
  readonly browser: HeldBackend;
  readonly native: HeldBackend;
  readonly connection;

  constructor() {
    const parts = testServices(testCatalog('test'));
    super(parts, testCraft);
    this.projects = parts.projects;
    this.browser = parts.browser;
    this.native = parts.native;
    this.connection = parts.connection;
    this.model.load = () => Promise.resolve(); // its models have no bytes
    this.previews.startFollowing();
  }

  measured = () => null;

  openFiles(files: readonly File[]): Promise<boolean> {
    return this.model.openFiles(files);
  }

  get title(): string {
    return this.model.title;
  }

  cancelPreview(): void {
    this.previews.cancel();
  }

  protected follow(): void {
    this.previews.follow();
  }

  async #makePreview({ subject, parameters }: PreviewRequest): Promise<ShownWork> {
    if (this.refuses) throw this.refuses;
    return { kind: 'preview', report: {}, parameters, from: subject.key };
  }

  async #readResult({ outputs, report, parameters, mesh }: CraftResult): Promise<ShownWork> {
    await this.projects.blobs.read(outputs['made.ply']?.blob ?? '');
    return { kind: 'full', report, parameters, from: mesh };
  }

  /** As if the model with this hash had been opened. */
  take(blob: string): void {
    const mesh: BlobReference = { blob, bytes: 1, media_type: 'application/x-ply' };
    const source = { kind: 'sample', sample: blob, title: blob } as const;
    const model: CraftModel = { source, mesh, preview: mesh, report: {} };
    this.projects.do(testCraft.command({ label: 'Take' }, () => ({ model })));
  }
}

export const readyState: ConnectionState = {
  state: 'ready',
  status: {
    version: '1',
    cores: 1,
    memory_mb: 1,
    jobs_running: 0,
    jobs_queued: 0,
    upload_limit_bytes: 9,
    triangle_limit: 9,
  },
};

/** Without a worker, until `connection` says that it is ready. */
export function testServices(catalog: Catalog) {
  const storage = new MemoryStorage();
  return {
    projects: new ProjectStore(storage, new BlobStore(storage)),
    catalog: signal<Catalog | null>(catalog),
    catalogError: signal<string | null>(null),
    browser: new HeldBackend('wasm'),
    native: new HeldBackend('native'),
    connection: signal<ConnectionState | null>(null),
    worker: null,
  };
}

/** As if made of `mesh`; its bytes are not there. */
export const resultOf = (mesh: string, report: Report = {}): CraftResult => ({
  id: `of ${mesh}`,
  made_unix_s: 0,
  backend: 'wasm',
  seconds: 1,
  mesh,
  parameters: {},
  report,
  outputs: { 'made.ply': { blob: 'gone', bytes: 3, media_type: 'application/x-ply' } },
});

/** Until everything that waits for nothing outside is done. */
export const settled = () => new Promise((resolve) => setTimeout(resolve, 20));
