// SPDX-License-Identifier: GPL-3.0-or-later
import { IndexedDbStorage } from './indexeddb_storage';
import { OpfsStorage } from './opfs_storage';
import type { ProjectStorage } from './storage';
import { MemoryStorage } from './storage';

/** The best place this browser offers; memory, which forgets, comes last. */
export async function openStorage(): Promise<ProjectStorage> {
  try {
    return await OpfsStorage.open();
  } catch {
    // No private file system, or one that pages may not write.
  }
  try {
    return await IndexedDbStorage.open();
  } catch {
    return new MemoryStorage();
  }
}
