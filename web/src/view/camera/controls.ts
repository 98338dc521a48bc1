// SPDX-License-Identifier: GPL-3.0-or-later
// Hand and keyboard on the viewport: orbit, pan, zoom. Says what is wanted; the viewport does it.

export interface ControlTarget {
  /** A press begins; true keeps the camera still (something is being drawn or dragged), a function until it is called. */
  press(event: PointerEvent): boolean | (() => void);
  /** The point about which this press will turn. */
  beginOrbit(event: PointerEvent): void;
  orbitBy(azimuth: number, elevation: number): void;
  panBy(dxPx: number, dyPx: number): void;
  zoomBy(factor: number, xPx: number, yPx: number): void;
  release(event: PointerEvent, clicked: boolean): void;
  hover(event: PointerEvent): void;
  leave(): void;
  command(name: 'viewpoint' | 'fit'): void;
  dragging(active: boolean): void;
  /** Keeps turning after the hand let go, radians per ms; not called under reduced motion. */
  coast(azimuthRate: number, elevationRate: number): void;
  stopCoasting(): void;
}

const RADIANS_PER_PIXEL = 0.0065;
const CLICK_SLOP_PX = 4;
const KEY_STEP = (5 * Math.PI) / 180;

type Held = { x: number; y: number };

export class Controls {
  private readonly held = new Map<number, Held>();
  private action: 'none' | 'orbit' | 'pan' | 'kept' = 'none';
  /** Called when a kept press is taken away; null where it cannot be. */
  private lost: (() => void) | null = null;
  private travelled = 0;
  private rate: [number, number] = [0, 0];
  private lastMove = 0;

  constructor(
    private readonly root: HTMLElement,
    private readonly canvas: HTMLElement,
    private readonly target: ControlTarget,
  ) {
    canvas.addEventListener('pointerdown', this.down);
    canvas.addEventListener('pointermove', this.move);
    canvas.addEventListener('pointerup', this.up);
    canvas.addEventListener('pointercancel', this.up);
    canvas.addEventListener('pointerleave', this.leave);
    canvas.addEventListener('wheel', this.wheel, { passive: false });
    canvas.addEventListener('contextmenu', prevent);
    root.addEventListener('keydown', this.key);
  }

  dispose(): void {
    const { canvas } = this;
    canvas.removeEventListener('pointerdown', this.down);
    canvas.removeEventListener('pointermove', this.move);
    canvas.removeEventListener('pointerup', this.up);
    canvas.removeEventListener('pointercancel', this.up);
    canvas.removeEventListener('pointerleave', this.leave);
    canvas.removeEventListener('wheel', this.wheel);
    canvas.removeEventListener('contextmenu', prevent);
    this.root.removeEventListener('keydown', this.key);
  }

  private local(event: { clientX: number; clientY: number }): Held {
    const box = this.canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  private readonly down = (event: PointerEvent): void => {
    this.target.stopCoasting();
    this.root.focus({ preventScroll: true });
    this.held.set(event.pointerId, this.local(event));
    this.canvas.setPointerCapture(event.pointerId);
    if (this.held.size > 1) {
      const moves = this.action !== 'kept' || this.lost !== null;
      this.takeAway();
      if (moves) this.action = 'pan';
      return;
    }
    this.travelled = 0;
    this.rate = [0, 0];
    const kept = this.target.press(event);
    this.lost = typeof kept === 'function' ? kept : null;
    if (kept) this.action = 'kept';
    else if (event.button === 0 && !event.shiftKey) {
      this.action = 'orbit';
      this.target.beginOrbit(event);
    } else this.action = 'pan';
    if (event.button === 1) event.preventDefault();
  };

  private readonly move = (event: PointerEvent): void => {
    const before = this.held.get(event.pointerId);
    if (!before) {
      this.target.hover(event);
      return;
    }
    const now = this.local(event);
    const dx = now.x - before.x;
    const dy = now.y - before.y;
    const spreadBefore = this.spread();
    this.held.set(event.pointerId, now);
    this.travelled += Math.hypot(dx, dy);
    if (this.action === 'kept') {
      this.target.hover(event);
      return;
    }
    if (this.travelled > CLICK_SLOP_PX) this.target.dragging(true);
    if (this.held.size > 1) {
      // Two fingers: their middle pans, their distance zooms.
      const after = this.spread();
      this.target.panBy(dx / this.held.size, dy / this.held.size);
      if (spreadBefore.distance > 0) {
        this.target.zoomBy(after.distance / spreadBefore.distance, after.x, after.y);
      }
      return;
    }
    if (this.action === 'pan') this.target.panBy(dx, dy);
    if (this.action === 'orbit') {
      const turn: [number, number] = [-dx * RADIANS_PER_PIXEL, dy * RADIANS_PER_PIXEL];
      this.target.orbitBy(...turn);
      const elapsed = Math.max(1, event.timeStamp - this.lastMove);
      const keep = Math.exp(-elapsed / 40);
      this.rate = [0, 1].map(
        (k) => keep * (this.rate[k] as number) + (1 - keep) * ((turn[k] as number) / elapsed),
      ) as [number, number];
      this.lastMove = event.timeStamp;
    }
  };

  private readonly up = (event: PointerEvent): void => {
    if (!this.held.delete(event.pointerId)) return;
    if (this.held.size > 0) return;
    const clicked = event.type === 'pointerup' && this.travelled <= CLICK_SLOP_PX;
    if (event.type === 'pointercancel') this.takeAway();
    this.lost = null;
    const resting = event.timeStamp - this.lastMove > 60;
    if (this.action === 'orbit' && !clicked && !resting) this.target.coast(...this.rate);
    this.action = 'none';
    this.target.dragging(false);
    this.target.release(event, clicked);
  };

  private takeAway(): void {
    this.lost?.();
    this.lost = null;
  }

  private readonly leave = (): void => {
    if (this.held.size === 0) this.target.leave();
  };

  private readonly wheel = (event: WheelEvent): void => {
    event.preventDefault();
    this.target.stopCoasting();
    const { x, y } = this.local(event);
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1;
    // A pinch on a touchpad arrives as a wheel with Ctrl and small steps.
    const rate = event.ctrlKey ? 0.01 : 0.0016;
    this.target.zoomBy(Math.exp(-Math.max(-240, Math.min(240, event.deltaY * lines)) * rate), x, y);
  };

  private readonly key = (event: KeyboardEvent): void => {
    if (event.target !== this.root || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = event.shiftKey ? 3 * KEY_STEP : KEY_STEP;
    const { width, height } = this.canvas.getBoundingClientRect();
    const actions: Record<string, () => void> = {
      ArrowLeft: () => this.target.orbitBy(-step, 0),
      ArrowRight: () => this.target.orbitBy(step, 0),
      ArrowUp: () => this.target.orbitBy(0, step),
      ArrowDown: () => this.target.orbitBy(0, -step),
      '+': () => this.target.zoomBy(1.2, width / 2, height / 2),
      '=': () => this.target.zoomBy(1.2, width / 2, height / 2),
      '-': () => this.target.zoomBy(1 / 1.2, width / 2, height / 2),
      '\u2212': () => this.target.zoomBy(1 / 1.2, width / 2, height / 2),
      '0': () => this.target.command('viewpoint'),
      f: () => this.target.command('fit'),
      F: () => this.target.command('fit'),
    };
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    this.target.stopCoasting();
    action();
  };

  private spread(): { x: number; y: number; distance: number } {
    const [a, b] = [...this.held.values()];
    if (!a || !b) return { x: a?.x ?? 0, y: a?.y ?? 0, distance: 0 };
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, distance: Math.hypot(a.x - b.x, a.y - b.y) };
  }
}

function prevent(event: Event): void {
  event.preventDefault();
}
