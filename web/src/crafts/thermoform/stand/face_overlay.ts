// SPDX-License-Identifier: GPL-3.0-or-later
// Draws the faces to place a model on over the viewport, and finds the one under the pointer. Faces of a convex hull
// that look towards the eye never lie over each other, so that flat shapes are enough.
import type { Viewport } from '../../../view';
import type { ThermoformSession } from '../thermoform_session';
import type { FaceTool } from './face_tool';
import type { Pixel } from './outline';
import { distanceTo, signedArea } from './outline';
import { pointAt } from './place_model';

interface DrawnFace {
  readonly outline: readonly Pixel[];
  readonly facing: boolean;
}

/** Beside a face this far it still is meant. */
const slack_px = 14;
const clickSlop_px = 4;

export class FaceOverlay {
  readonly #session: ThermoformSession;
  readonly #tool: FaceTool;
  readonly #viewport: Viewport;
  readonly #svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  #faces: readonly DrawnFace[] = [];
  #pressed: Pixel | null = null;

  constructor(session: ThermoformSession, tool: FaceTool, viewport: Viewport) {
    this.#session = session;
    this.#tool = tool;
    this.#viewport = viewport;
    this.#svg.setAttribute('class', 'face-overlay');
    this.#svg.setAttribute('aria-hidden', 'true');
    viewport.overlay.append(this.#svg);
    const { canvas } = viewport;
    canvas.addEventListener('pointermove', this.#move);
    canvas.addEventListener('pointerdown', this.#down);
    canvas.addEventListener('pointerup', this.#up);
    canvas.addEventListener('pointerleave', this.#leave);
  }

  dispose(): void {
    const { canvas } = this.#viewport;
    canvas.removeEventListener('pointermove', this.#move);
    canvas.removeEventListener('pointerdown', this.#down);
    canvas.removeEventListener('pointerup', this.#up);
    canvas.removeEventListener('pointerleave', this.#leave);
    this.#svg.remove();
  }

  /** With the camera of the picture that was just drawn. */
  place(): void {
    const sides = this.#tool.sides.peek();
    const placement = this.#session.placement.peek();
    if (sides === null && this.#faces.length === 0) return;
    this.#faces = (placement && sides ? sides : []).map(({ outline }) => {
      const pixels = outline.map((point): Pixel | null => {
        const at = this.#viewport.project(pointAt(placement ?? [], point));
        return at && [at.xPx, at.yPx];
      });
      const seen = pixels.filter((pixel) => pixel !== null);
      return { outline: seen, facing: seen.length === pixels.length && signedArea(seen) < 0 };
    });
    while (this.#svg.childElementCount > this.#faces.length) this.#svg.lastElementChild?.remove();
    while (this.#svg.childElementCount < this.#faces.length)
      this.#svg.append(document.createElementNS('http://www.w3.org/2000/svg', 'polygon'));
    this.#faces.forEach(({ outline }, i) => {
      const points = outline.map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join(' ');
      this.#svg.children[i]?.setAttribute('points', points);
    });
    this.mark();
  }

  /** Which face is pointed at; without sides nothing is shown, whatever was drawn last. */
  mark(): void {
    const pointed = this.#tool.pointed.value;
    this.#svg.toggleAttribute('hidden', this.#tool.sides.value === null);
    this.#faces.forEach(({ facing }, i) => {
      const name = `${facing ? 'facing' : 'behind'}${i === pointed ? ' pointed' : ''}`;
      this.#svg.children[i]?.setAttribute('class', name);
    });
  }

  #under(at: Pixel): number | null {
    let best: number | null = null;
    let least = slack_px;
    this.#faces.forEach(({ outline, facing }, i) => {
      const distance = facing ? distanceTo(outline, at) : Infinity;
      if (distance < least) [best, least] = [i, distance];
    });
    return best;
  }

  readonly #place = (event: PointerEvent): Pixel => {
    const box = this.#viewport.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };

  readonly #move = (event: PointerEvent): void => {
    if (this.#tool.sides.peek() === null || event.buttons !== 0) return;
    this.#tool.pointed.value = this.#under(this.#place(event));
    this.#viewport.canvas.style.cursor = this.#tool.pointed.value === null ? '' : 'pointer';
  };

  readonly #down = (event: PointerEvent): void => {
    this.#pressed = event.button === 0 ? this.#place(event) : null;
  };

  /** A click takes a face, a drag turns the view. */
  readonly #up = (event: PointerEvent): void => {
    const [pressed, at] = [this.#pressed, this.#place(event)];
    this.#pressed = null;
    if (this.#tool.sides.peek() === null || pressed === null) return;
    if (Math.hypot(at[0] - pressed[0], at[1] - pressed[1]) > clickSlop_px) return;
    this.#viewport.canvas.style.cursor = '';
    this.#tool.take(this.#under(at));
  };

  readonly #leave = (): void => {
    if (this.#tool.sides.peek() !== null) this.#tool.pointed.value = null;
  };
}
