// SPDX-License-Identifier: GPL-3.0-or-later
// What the app hands to every craft.
import type { ReadonlySignal } from '@preact/signals';
import type { Backend } from '../../jobs/backend';
import type { Catalog } from '../../jobs/contract';
import type { ConnectionState, NativeConnection } from '../../jobs/native_connection';
import type { ProjectStore } from '../../project/project_store';

export interface Services {
  readonly projects: ProjectStore;
  /** Null until a backend has answered. */
  readonly catalog: ReadonlySignal<Catalog | null>;
  /** Why there is no catalog, in a sentence. */
  readonly catalogError: ReadonlySignal<string | null>;
  /** The core in this browser; previews run here. */
  readonly browser: Backend & { readonly memory_mb?: number };
  /** The native worker, where there is one. */
  readonly native: Backend | null;
  readonly connection: ReadonlySignal<ConnectionState | null>;
  /** The line to the worker, for what is no job: its machines. */
  readonly worker: NativeConnection | null;
}

/** The worker while it answers, else null. */
export const readyWorker = (services: Services): Backend | null =>
  services.connection.value?.state === 'ready' ? services.native : null;
