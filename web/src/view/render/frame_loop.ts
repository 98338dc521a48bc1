// SPDX-License-Identifier: GPL-3.0-or-later
// When to draw: on demand. A change draws at once; at rest the light is baked, then the still picture is
// refined some samples at a time; then nothing runs until the next change.
import type { FrameStats } from '../api';

export interface FrameClient {
  /** Moves what moves (camera, coasting); true while something still does. */
  animate(now: number, elapsed: number): boolean;
  draw(): void;
  /** Puts a picture that was drawn aside and is done onto the canvas; true when there was one. */
  present(): boolean;
  bakePending(): boolean;
  /** Some of the baking; true when the picture should be drawn again. */
  bake(): boolean;
  /** How many samples a still picture gets; 0 for none. */
  refineSamples(): number;
  refine(sample: number): void;
  triangles(): number;
  /** The graphics card has not finished what it was given. */
  gpuBusy(): boolean;
  onFrame(stats: FrameStats): void;
  /** Whether there is more to draw than what is to be seen. */
  onDrawing(drawing: boolean): void;
}

/** How soon to look again whether the card is done: soon after a frame's length. */
const POLL_MS = 8;
/** A slow machine refines no longer than this. */
const REFINE_BUDGET_MS = 2500;
const FEWEST_SAMPLES = 8;

export class FrameLoop {
  private request = 0;
  private timer = 0;
  private dirty = true;
  private changedAt = -Infinity;
  private last: number | null = null;
  private sample = 0;
  private refinedSince = 0;
  private finished = false;
  private waiting: (() => void)[] = [];
  private stopped = false;
  private held = false;

  constructor(
    private readonly client: FrameClient,
    /** Rest before baking and refining, so that they never get in the way of the hand, ms. */
    private readonly restMs: number,
  ) {}

  invalidate(): void {
    this.dirty = true;
    this.restart();
  }

  /** Something at rest may go on (baking needed) without drawing first. */
  restart(): void {
    this.sample = 0;
    this.finished = false;
    this.client.onDrawing(true);
    if (this.stopped) return;
    clearTimeout(this.timer);
    this.timer = 0;
    if (this.request === 0) this.request = requestAnimationFrame(this.tick);
  }

  stop(): void {
    this.stopped = true;
    cancelAnimationFrame(this.request);
    clearTimeout(this.timer);
    this.request = this.timer = 0;
    this.last = null;
    this.release();
  }

  start(): void {
    this.stopped = false;
    this.invalidate();
  }

  /** Held, changes are drawn but nothing is baked or refined. */
  setHeld(held: boolean): void {
    if (held === this.held) return;
    this.held = held;
    if (!held) this.restart();
  }

  get idle(): boolean {
    return this.finished || this.stopped;
  }

  settled(): Promise<void> {
    return this.idle ? Promise.resolve() : new Promise((resolve) => this.waiting.push(resolve));
  }

  drawNow(): void {
    if (this.stopped) return;
    this.dirty = false;
    this.changedAt = performance.now();
    this.client.draw();
    this.client.present();
  }

  private later(ms: number): void {
    this.timer = window.setTimeout(() => {
      this.timer = 0;
      if (this.request === 0 && !this.stopped) this.request = requestAnimationFrame(this.tick);
    }, ms);
  }

  private release(): void {
    const waiting = this.waiting;
    this.waiting = [];
    for (const resolve of waiting) resolve();
  }

  private readonly tick = (now: number): void => {
    this.request = 0;
    if (this.stopped) return;
    // Never a second frame in the queue: the hand would feel it, and the page would stop.
    if (this.client.gpuBusy()) {
      this.later(POLL_MS);
      return;
    }
    if (this.client.present()) {
      this.request = requestAnimationFrame(this.tick);
      return;
    }
    const begun = performance.now();
    const interval = this.last === null ? null : now - this.last;
    const moving = this.client.animate(now, interval ?? 16);
    if (moving) this.dirty = true;
    let refinement = 0;
    if (this.dirty) {
      this.dirty = false;
      this.sample = 0;
      this.changedAt = now;
      this.client.draw();
    } else if (now - this.changedAt < this.restMs) {
      this.last = null;
      this.later(this.restMs - (now - this.changedAt));
      return;
    } else if (this.held) {
      this.last = null;
      return; // setHeld goes on
    } else if (this.client.bakePending()) {
      if (this.client.bake()) {
        this.client.draw();
        this.sample = 0;
      }
    } else {
      const samples = this.client.refineSamples();
      if (this.sample === 0) this.refinedSince = now;
      const late = this.sample >= FEWEST_SAMPLES && now - this.refinedSince > REFINE_BUDGET_MS;
      if (this.sample >= samples || late) {
        this.finished = true;
        this.last = null;
        this.client.onDrawing(false);
        this.client.onFrame({
          cpuMs: 0,
          intervalMs: null,
          triangles: this.client.triangles(),
          refinement: 1,
        });
        this.release();
        return;
      }
      this.client.refine(this.sample++);
      refinement = this.sample / samples;
    }
    this.client.onFrame({
      cpuMs: performance.now() - begun,
      intervalMs: interval,
      triangles: this.client.triangles(),
      refinement,
    });
    this.last = now;
    this.request = requestAnimationFrame(this.tick);
  };
}
