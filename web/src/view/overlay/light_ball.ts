// SPDX-License-Identifier: GPL-3.0-or-later
import '../view.css';
import type { LightBallApi, LightDirection } from '../api';
import {
  DEFAULT_LIGHT,
  dotOf,
  lightAt,
  normalisedAzimuth,
  spokenDirection,
  spokenLight,
} from '../render/light';

const NS = 'http://www.w3.org/2000/svg';
const RADIUS = 26;
let count = 0;

function svg<K extends keyof SVGElementTagNameMap>(
  name: K,
  attributes: Record<string, string | number>,
): SVGElementTagNameMap[K] {
  const element = document.createElementNS(NS, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
  return element;
}

/** A ball with a dot where the light comes from. Drag the dot, or use its two sliders (direction, height)
 *  by keyboard: arrows 5 degrees, with Shift 1, Page 15, Home and End to the ends; double click restores. */
export class LightBall implements LightBallApi {
  readonly element = document.createElement('div');
  private readonly ball = svg('svg', { viewBox: '0 0 60 60', 'aria-hidden': 'true' });
  private readonly dot = svg('circle', { r: 6, class: 'dot' });
  private readonly ray = svg('path', { class: 'ray' });
  private readonly gradient = svg('radialGradient', { id: `fw-light-${++count}`, r: 0.95 });
  private readonly azimuth: HTMLElement;
  private readonly elevation: HTMLElement;

  constructor(
    private light: LightDirection,
    private readonly onChange: (light: LightDirection, done: boolean) => void,
  ) {
    this.element.className = 'fw-light';
    for (const [offset, colour] of [
      [0, '#fffaf0'],
      [0.5, '#d8cfc0'],
      [1, '#857c6d'],
    ] as const) {
      this.gradient.append(svg('stop', { offset, 'stop-color': colour }));
    }
    const defs = svg('defs', {});
    defs.append(this.gradient);
    const sphere = svg('circle', { cx: 30, cy: 30, r: RADIUS, fill: `url(#${this.gradient.id})` });
    this.ball.append(defs, sphere, this.ray, this.dot);
    this.azimuth = this.slider('Light direction', 0, 360);
    this.elevation = this.slider('Light height', 5, 90);
    const caption = document.createElement('span');
    caption.textContent = 'Light';
    this.element.append(this.ball, this.azimuth, this.elevation, caption);
    this.ball.addEventListener('pointerdown', this.press);
    this.ball.addEventListener('dblclick', () =>
      this.change({ ...DEFAULT_LIGHT, follows: this.light.follows ?? 'object' }, true),
    );
    this.draw();
  }

  setLight(light: LightDirection): void {
    this.light = light;
    this.draw();
  }

  dispose(): void {
    this.element.remove();
  }

  private slider(label: string, minimum: number, maximum: number): HTMLElement {
    const element = document.createElement('div');
    element.tabIndex = 0;
    element.setAttribute('role', 'slider');
    element.setAttribute('aria-label', label);
    element.setAttribute('aria-valuemin', String(minimum));
    element.setAttribute('aria-valuemax', String(maximum));
    element.addEventListener('keydown', (event) => this.key(event, element));
    return element;
  }

  private key(event: KeyboardEvent, element: HTMLElement): void {
    const step = event.shiftKey ? 1 : 5;
    const by: Record<string, number> = {
      ArrowRight: step,
      ArrowUp: step,
      ArrowLeft: -step,
      ArrowDown: -step,
      PageUp: 15,
      PageDown: -15,
    };
    const azimuthal = element === this.azimuth;
    const delta = by[event.key];
    let { azimuthDeg, elevationDeg } = this.light;
    if (event.key === 'Home' || event.key === 'End') {
      if (azimuthal) azimuthDeg = event.key === 'Home' ? 0 : 355;
      else elevationDeg = event.key === 'Home' ? 5 : 90;
    } else if (delta === undefined) return;
    else if (azimuthal) azimuthDeg = normalisedAzimuth(azimuthDeg + delta);
    else elevationDeg = Math.min(90, Math.max(5, elevationDeg + delta));
    event.preventDefault();
    event.stopPropagation();
    this.change({ ...this.light, azimuthDeg, elevationDeg }, true);
  }

  private readonly press = (event: PointerEvent): void => {
    if (event.button !== 0) return;
    event.preventDefault();
    this.azimuth.focus({ preventScroll: true });
    this.ball.setPointerCapture(event.pointerId);
    const move = (e: PointerEvent, done: boolean): void => {
      const box = this.ball.getBoundingClientRect();
      const unit = (box.width / 60) * RADIUS;
      const x = (e.clientX - box.left - box.width / 2) / unit;
      const y = -(e.clientY - box.top - box.height / 2) / unit;
      this.change(lightAt(x, y, this.light), done);
    };
    const drag = (e: PointerEvent): void => move(e, false);
    const release = (e: PointerEvent): void => {
      this.ball.removeEventListener('pointermove', drag);
      this.ball.removeEventListener('pointerup', release);
      this.ball.removeEventListener('pointercancel', release);
      if (e.type === 'pointerup') move(e, true);
      else this.onChange(this.light, true);
    };
    this.ball.addEventListener('pointermove', drag);
    this.ball.addEventListener('pointerup', release);
    this.ball.addEventListener('pointercancel', release);
    move(event, false);
  };

  private change(light: LightDirection, done: boolean): void {
    this.light = light;
    this.draw();
    this.onChange(light, done);
  }

  private draw(): void {
    const [x, y] = dotOf(this.light);
    const cx = 30 + 0.8 * RADIUS * x;
    const cy = 30 - 0.8 * RADIUS * y;
    this.dot.setAttribute('cx', cx.toFixed(1));
    this.dot.setAttribute('cy', cy.toFixed(1));
    this.ray.setAttribute('d', `M${cx.toFixed(1)} ${cy.toFixed(1)}L30 30`);
    this.gradient.setAttribute('cx', (0.5 + 0.3 * x).toFixed(3));
    this.gradient.setAttribute('cy', (0.5 - 0.3 * y).toFixed(3));
    this.azimuth.setAttribute('aria-valuenow', String(Math.round(this.light.azimuthDeg)));
    this.azimuth.setAttribute('aria-valuetext', spokenLight(this.light));
    this.elevation.setAttribute('aria-valuenow', String(Math.round(this.light.elevationDeg)));
    this.elevation.setAttribute(
      'aria-valuetext',
      `${Math.round(this.light.elevationDeg)} degrees high, ${spokenDirection(this.light)}`,
    );
  }
}
