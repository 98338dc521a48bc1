// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps the page from asking more of the graphics card than it has done. Commands are only queued by the
// browser; whoever queues without looking blocks the main thread at the first call that needs an answer.

const POLL_MS = 6;
/** A driver that never says it is done must not stop the drawing. */
const GIVE_UP_MS = 20_000;

export class GpuPace {
  private sync: WebGLSync | null = null;
  private begun = 0;
  /** How long the last marked work took, from its last command to its end, ms. */
  lastMs = 0;

  constructor(private readonly gl: WebGL2RenderingContext) {}

  /** Call when a piece of work has been queued. */
  mark(): void {
    const { gl } = this;
    if (this.sync) gl.deleteSync(this.sync);
    this.sync = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    this.begun = performance.now();
    gl.flush();
  }

  get busy(): boolean {
    if (!this.sync) return false;
    const { gl } = this;
    const took = performance.now() - this.begun;
    if (
      gl.getSyncParameter(this.sync, gl.SYNC_STATUS) !== gl.SIGNALED &&
      !gl.isContextLost() &&
      took < GIVE_UP_MS
    )
      return true;
    gl.deleteSync(this.sync);
    this.sync = null;
    this.lastMs = took;
    return false;
  }

  /** The context was lost: what was marked on it is neither done nor told of. */
  forget(): void {
    this.sync = null;
  }

  /** Resolves when the work marked last is done. */
  async done(): Promise<void> {
    while (this.busy) await new Promise((resolve) => setTimeout(resolve, POLL_MS));
  }
}
