// SPDX-License-Identifier: GPL-3.0-or-later
// One tab to a project: every save writes the whole document, so two tabs on one project would take turns in
// erasing each other's work. A Web Lock is held for as long as a project is open.

type Locks = Pick<LockManager, 'request'>;
type Release = () => void;

/** A page that is being reloaded, or has just turned to another project, may hold its lock for a moment longer. */
const usualPatience_ms = 500;

export class ProjectLocks {
  readonly #locks: Locks | undefined;
  readonly #patience_ms: number;
  readonly #asked = new Map<string, Promise<Release | null>>();

  /** Without `locks` (no secure context, an old browser) nobody can tell: every project is free. */
  constructor(locks?: Locks, patience_ms = usualPatience_ms) {
    this.#locks = locks;
    this.#patience_ms = patience_ms;
  }

  /** Whether the project is this tab's now; waits a moment for another tab to let go of it. */
  async take(id: string): Promise<boolean> {
    const asked = this.#asked.get(id) ?? this.#ask(id, this.#patience_ms);
    this.#asked.set(id, asked);
    if ((await asked) !== null) return true;
    this.#asked.delete(id);
    return false;
  }

  /** For a project that was made just now: no other tab has it, so that however slow the browser is, it is not refused. */
  async takeNew(id: string): Promise<void> {
    const asked = this.#ask(id, Infinity);
    this.#asked.set(id, asked);
    await asked;
  }

  release(id: string): void {
    void this.#asked.get(id)?.then((release) => release?.());
    this.#asked.delete(id);
  }

  async #ask(id: string, patience_ms: number): Promise<Release | null> {
    const locks = this.#locks;
    const free: Release = () => undefined;
    if (locks === undefined) return free;
    const abort = new AbortController();
    const timer = Number.isFinite(patience_ms) ? setTimeout(() => abort.abort(), patience_ms) : undefined;
    try {
      return await new Promise<Release>((resolve, reject) => {
        const held = () => new Promise<void>((release) => resolve(release));
        locks.request(`formwright.project.${id}`, { signal: abort.signal }, held).catch(reject);
      });
    } catch {
      return abort.signal.aborted ? null : free; // a browser that refuses locks is one without them
    } finally {
      clearTimeout(timer);
    }
  }
}
