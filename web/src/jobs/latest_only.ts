// SPDX-License-Identifier: GPL-3.0-or-later
// A queue of length one for live previews: while a task runs only the newest request waits. What runs is
// left to finish, so that the picture moves while a slider is dragged and a factorisation begun is not
// thrown away at every step; only a task of no use to the newer request is aborted.

export class LatestOnly<Request> {
  #running: { readonly abort: AbortController; readonly request: Request } | null = null;
  #waiting: { readonly request: Request } | null = null;
  readonly #task: (request: Request, signal: AbortSignal) => Promise<void>;
  readonly #isObsolete: (running: Request, next: Request) => boolean;
  readonly #isSame: (running: Request, next: Request) => boolean;

  constructor(
    task: (request: Request, signal: AbortSignal) => Promise<void>,
    isObsolete: (running: Request, next: Request) => boolean = () => false,
    isSame: (running: Request, next: Request) => boolean = () => false,
  ) {
    this.#isSame = isSame;
    this.#task = task;
    this.#isObsolete = isObsolete;
  }

  get busy(): boolean {
    return this.#running !== null;
  }

  request(request: Request): void {
    const running = this.#running;
    if (running && !running.abort.signal.aborted && this.#isSame(running.request, request)) {
      this.#waiting = null; // the newest is what runs
      return;
    }
    this.#waiting = { request };
    if (this.#running === null) void this.#drain();
    else if (this.#isObsolete(this.#running.request, request)) this.#running.abort.abort();
  }

  /** Drops what waits and aborts what runs. */
  cancel(): void {
    this.#waiting = null;
    this.#running?.abort.abort();
  }

  async #drain(): Promise<void> {
    while (this.#waiting !== null) {
      const { request } = this.#waiting;
      this.#waiting = null;
      const abort = new AbortController();
      this.#running = { abort, request };
      try {
        await this.#task(request, abort.signal);
      } catch {
        // The task reports its own failures; the queue only has to go on.
      }
    }
    this.#running = null;
  }
}
