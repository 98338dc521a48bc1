// SPDX-License-Identifier: GPL-3.0-or-later
// Wires backends, storage and catalog together, once, at the start.
import { signal } from '@preact/signals';
import type { Services } from '../shared/session/services';
import type { Backend, BlobSource } from '../jobs/backend';
import type { Catalog } from '../jobs/contract';
import { asJobError } from '../jobs/contract';
import { NativeBackend } from '../jobs/native_backend';
import type { ConnectionState } from '../jobs/native_connection';
import { takeToken } from '../jobs/native_connection';
import { WasmModules } from '../jobs/wasm_modules';
import { BlobStore } from '../project/blob_store';
import { openStorage } from '../project/open_storage';
import { ProjectLocks } from '../project/project_locks';
import { ProjectStore } from '../project/project_store';
import { toast } from '../ui';
import { lastProject, rememberProject } from './last_project';
import { askBeforeLeaving } from './leaving';

const moduleUrl = (module: string) => new URL(`wasm/${module}.mjs`, document.baseURI.replace(/#.*/, '')).href;

/** The core in this page. Only `vite dev` without a WASM build, and `vite build --mode mock`, have a stand-in. */
async function browserBackend(blobs: BlobSource): Promise<Backend> {
  if (import.meta.env.DEV || import.meta.env.MODE === 'mock') {
    const answer = await fetch(moduleUrl('formwright'), { method: 'HEAD' }).catch(() => null);
    const built = answer?.ok === true && /javascript/.test(answer.headers.get('content-type') ?? '');
    if (!built || import.meta.env.MODE === 'mock') {
      const { MockBackend } = await import('../jobs/mock/mock_backend');
      return new MockBackend(blobs);
    }
  }
  return new WasmModules({ moduleUrl, blobs });
}

/** Blobs that no project names any more are deleted, unless another tab may be about to name them. */
async function sweepWhenAlone(projects: ProjectStore): Promise<void> {
  const name = 'formwright.page';
  await navigator.locks?.request(name, { ifAvailable: true }, async (lock) => {
    if (lock) await projects.sweep().catch(() => undefined);
  });
  void navigator.locks?.request(name, { mode: 'shared' }, () => new Promise(() => undefined));
}

export async function createServices(): Promise<Services> {
  const storage = await openStorage();
  const blobs = new BlobStore(storage);
  const projects = new ProjectStore(storage, blobs, new ProjectLocks(navigator.locks));
  const token = takeToken(location, sessionStorage, (url) => history.replaceState(null, '', url));
  const connection = signal<ConnectionState | null>(null);
  const native = token
    ? new NativeBackend({
        origin: location.origin,
        token,
        blobs,
        onState: (state) => (connection.value = state),
      })
    : null;

  const catalog = signal<Catalog | null>(null);
  const catalogError = signal<string | null>(null);
  const own = await browserBackend(blobs);
  let browser = own;
  const ready = own
    .catalog()
    .catch(async (thrown: unknown) => {
      if (native === null) throw thrown;
      browser = native; // a worker without a WASM build runs the previews as well
      return await native.catalog();
    })
    .then(
      (found) => (catalog.value = found),
      (thrown: unknown) => (catalogError.value = asJobError(thrown).message),
    );

  const load = projects.load(lastProject(sessionStorage, localStorage)).then((instead) => {
    if (instead !== null) toast(instead);
  });
  await (native === null ? load : Promise.all([load, ready]));
  void sweepWhenAlone(projects);
  rememberProject(projects, sessionStorage, localStorage);
  askBeforeLeaving(projects, window);
  return {
    projects,
    catalog,
    catalogError,
    get browser() {
      return browser;
    },
    native,
    connection,
    worker: native?.connection ?? null,
  };
}
