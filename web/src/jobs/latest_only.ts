// SPDX-License-Identifier: GPL-3.0-or-later
// A queue of length one for live previews: while a task runs only the newest request waits. Short tasks
// are left to finish, so that the picture moves while a slider is dragged; one that has run for longer
// than `patience_ms` when a newer request comes is aborted.

export class LatestOnly<Request> {
  #running: AbortController | null = null;
  #startedAt = 0;
  #waiting: { request: Request } | null = null;
  readonly #task: (request: Request, signal: AbortSignal) => Promise<void>;
  readonly #patience_ms: number;

  constructor(task: (request: Request, signal: AbortSignal) => Promise<void>, patience_ms = 400) {
    this.#task = task;
    this.#patience_ms = patience_ms;
  }

  get busy(): boolean {
    return this.#running !== null;
  }

  request(request: Request): void {
    this.#waiting = { request };
    if (this.#running === null) void this.#drain();
    else if (performance.now() - this.#startedAt > this.#patience_ms) this.#running.abort();
  }

  /** Drops what waits and aborts what runs. */
  cancel(): void {
    this.#waiting = null;
    this.#running?.abort();
  }

  async #drain(): Promise<void> {
    while (this.#waiting !== null) {
      const { request } = this.#waiting;
      this.#waiting = null;
      const controller = new AbortController();
      this.#running = controller;
      this.#startedAt = performance.now();
      try {
        await this.#task(request, controller.signal);
      } catch {
        // The task reports its own failures; the queue only has to go on.
      }
    }
    this.#running = null;
  }
}
