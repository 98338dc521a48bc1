// SPDX-License-Identifier: GPL-3.0-or-later
// How pictures get onto the canvas: at once, or drawn aside and shown when done, or averaged while at rest.
import { Accumulation } from './passes';
import type { Picture } from './picture';
import type { Stage } from './stage';

/** A still picture is shown from this many samples on; fewer look rougher than the moving one. */
const SHOWN_FROM = 8;

export class Painter {
  private accumulation: Accumulation | null = null;
  private unshown: 'average' | 'frame' | null = null;

  constructor(
    private readonly stage: Stage,
    private readonly canvas: HTMLCanvasElement,
  ) {}

  draw(picture: Picture): void {
    const { stage, canvas } = this;
    stage.renderer.info.reset();
    const aside = stage.quality.drawsAside ? this.aside() : null;
    stage.draw(picture, aside?.frame ?? null, canvas.width, canvas.height);
    this.unshown = aside ? 'frame' : null;
    stage.pace.mark();
  }

  /** Shows what was drawn aside; true when there was something. */
  present(): boolean {
    const { stage, accumulation } = this;
    if (!this.unshown || !accumulation) return false;
    accumulation.show(stage.renderer, this.unshown);
    this.unshown = null;
    stage.pace.mark();
    return true;
  }

  /** Adds one jittered picture to the still one. */
  refine(picture: Picture, sample: number): void {
    const { stage, canvas } = this;
    const aside = this.aside();
    stage.draw(picture, aside.frame, canvas.width, canvas.height, sample);
    aside.add(stage.renderer, sample);
    if (sample + 1 >= Math.min(SHOWN_FROM, stage.quality.stillSamples)) {
      if (stage.quality.drawsAside) this.unshown = 'average';
      else aside.show(stage.renderer, 'average');
    }
    stage.pace.mark();
  }

  private aside(): Accumulation {
    const { width, height } = this.canvas;
    if (this.accumulation?.width !== width || this.accumulation.height !== height) {
      this.accumulation?.dispose();
      this.accumulation = new Accumulation(width, height);
    }
    return this.accumulation;
  }

  /** Also after the context was lost. */
  dispose(): void {
    this.accumulation?.dispose();
    this.accumulation = null;
    this.unshown = null;
  }
}
