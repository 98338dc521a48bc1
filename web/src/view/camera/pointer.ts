// SPDX-License-Identifier: GPL-3.0-or-later
// What the pointer does beyond moving the camera: hover read-outs, presses and clicks for the page.
import type { Hit, ViewPointerEvent } from '../api';
import type { CameraRig } from './camera_rig';
import type { ControlTarget } from './controls';

export interface PointerClient {
  canvas: HTMLElement;
  rig: CameraRig;
  pick(xPx: number, yPx: number): Hit | null;
  /** Somebody wants to know: the page listens, or values are shown. */
  wanted(): boolean;
  onPointer(event: ViewPointerEvent): void;
  showValue(hit: Hit | null): void;
  command(name: 'viewpoint' | 'fit'): void;
  dragging(active: boolean): void;
}

export class PointerReports {
  private last: PointerEvent | null = null;
  private pending = 0;

  constructor(private readonly client: PointerClient) {}

  target(): ControlTarget {
    const { client } = this;
    const { rig } = client;
    return {
      press: (event) => {
        let kept: boolean | (() => void) = false;
        this.report('down', event, (onLost) => (kept = onLost ?? true));
        return kept;
      },
      beginOrbit: (event) => rig.setPivot(client.pick(...this.local(event))?.positionMm ?? null),
      orbitBy: (azimuth, elevation) => rig.orbitBy(azimuth, elevation),
      panBy: (dx, dy) => rig.panBy(dx, dy),
      zoomBy: (factor, x, y) => rig.zoomBy(factor, x, y),
      release: (event, clicked) => {
        this.report('up', event);
        if (clicked) this.report('click', event);
      },
      hover: (event) => {
        this.last = event;
        this.hoverLater();
      },
      leave: () => {
        this.last = null;
        client.showValue(null);
        client.onPointer({
          kind: 'leave',
          hit: null,
          xPx: NaN,
          yPx: NaN,
          button: -1,
          shiftKey: false,
          ctrlKey: false,
          capture: () => undefined,
        });
      },
      command: (name) => client.command(name),
      dragging: (active) => {
        client.dragging(active);
        if (active) client.showValue(null);
      },
      coast: (azimuth, elevation) => rig.coast(azimuth, elevation),
      stopCoasting: () => rig.stopCoasting(),
    };
  }

  /** Hovering asks at most once a frame, and costs no drawing. */
  hoverLater(): void {
    if (this.pending !== 0 || !this.last) return;
    this.pending = requestAnimationFrame(() => {
      this.pending = 0;
      if (this.last) this.client.showValue(this.report('move', this.last));
    });
  }

  dispose(): void {
    cancelAnimationFrame(this.pending);
    this.last = null;
  }

  private local(event: { clientX: number; clientY: number }): [number, number] {
    const box = this.client.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  private report(
    kind: 'move' | 'down' | 'up' | 'click',
    event: PointerEvent,
    capture: ViewPointerEvent['capture'] = () => undefined,
  ): Hit | null {
    if (!this.client.wanted()) return null;
    const [xPx, yPx] = this.local(event);
    const hit = this.client.pick(xPx, yPx);
    const { button, shiftKey, ctrlKey } = event;
    this.client.onPointer({ kind, hit, xPx, yPx, button, shiftKey, ctrlKey, capture });
    return hit;
  }
}
