// SPDX-License-Identifier: GPL-3.0-or-later
import '../view.css';
import type { SideInsetApi } from '../api';
import { type CameraState, cameraFromViewpoint, orbited } from '../camera/camera';
import { formatValue } from '../mesh/colour_map';
import type { Viewport } from '../viewport';

/** Turned this far to the side and from above, so that the thickness shows. */
const TURN = (62 * Math.PI) / 180;
const TILT = (14 * Math.PI) / 180;

/** The relief seen from the side, with its thickness. Call `update` when the relief or its light changed;
 *  it draws once the hand rests, with the viewport's own meshes and graphics context. */
export class SideInset implements SideInsetApi {
  readonly element = document.createElement('div');
  private readonly canvas = document.createElement('canvas');
  private readonly thickness = document.createElement('span');
  private timer = 0;
  private running = false;
  private again = false;
  private disposed = false;
  private readonly themeWatch = new MutationObserver(() => this.redraw());

  constructor(
    private readonly viewport: Viewport,
    private readonly size: { widthPx: number; heightPx: number } = { widthPx: 148, heightPx: 112 },
  ) {
    this.element.className = 'fw-inset';
    this.canvas.setAttribute('role', 'img');
    this.canvas.setAttribute('aria-label', 'The relief seen from the side');
    this.canvas.style.aspectRatio = `${size.widthPx} / ${size.heightPx}`;
    const caption = document.createElement('div');
    caption.className = 'cap';
    const name = document.createElement('span');
    name.textContent = 'Side';
    caption.append(name, this.thickness);
    this.element.append(this.canvas, caption);
    this.themeWatch.observe(document.documentElement, { attributes: true, attributeFilter: ['data-theme'] });
  }

  update(thicknessMm: number): void {
    const text = formatValue(thicknessMm, 'mm', 0.1);
    this.thickness.textContent = text;
    this.canvas.setAttribute('aria-label', `The relief seen from the side, ${text} thick`);
    this.redraw();
  }

  /** Light or theme changed. */
  redraw(): void {
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => void this.draw(), 150);
  }

  private async draw(): Promise<void> {
    if (this.running) {
      this.again = true;
      return;
    }
    this.running = true;
    const ratio = Math.min(globalThis.devicePixelRatio || 1, 2);
    const width = Math.round(this.size.widthPx * ratio);
    const height = Math.round(this.size.heightPx * ratio);
    const viewpoint = this.viewport.getViewpoint();
    const side = (centre: readonly [number, number, number], radius: number): CameraState => {
      const front = cameraFromViewpoint(
        { ...viewpoint, projection: 'perspective', targetMm: centre, distanceMm: 7 * radius },
        radius,
      );
      return orbited(front, front.up, centre, TURN, TILT);
    };
    try {
      const pixels = await this.viewport.readPart('relief', side, width, height);
      if (pixels && !this.disposed) {
        this.canvas.width = width;
        this.canvas.height = height;
        this.canvas.getContext('2d')?.putImageData(new ImageData(pixels, width, height), 0, 0);
      }
    } catch {
      // A lost context: the viewport says so, and the next update draws again.
    } finally {
      this.running = false;
    }
    if (this.again && !this.disposed) {
      this.again = false;
      await this.draw();
    }
  }

  dispose(): void {
    this.disposed = true;
    this.themeWatch.disconnect();
    clearTimeout(this.timer);
    this.element.remove();
  }
}
