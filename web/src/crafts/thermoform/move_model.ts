// SPDX-License-Identifier: GPL-3.0-or-later
// Moving the model about on the platform, by hand and by keys.
import type { Json } from '../../jobs/contract';
import type { Viewport } from '../../view';
import { boxOf, onLevel, placed } from './placement';
import type { ThermoformSession } from './thermoform_session';
import { dragging } from './views';

/** Steps of the arrow keys, and with Shift. */
const step_mm = 1;
const leap_mm = 10;
/** The part of the model's height below which a press on the sheet turns the view. */
const foot = 0.15;

const millimetre = (value: number) => Number(value.toFixed(1));

export class ModelMover {
  readonly #session: ThermoformSession;
  #grab: { x: number; y: number; level_mm: number } | null = null;

  constructor(session: ThermoformSession) {
    this.#session = session;
  }

  /** Whether a press at this point of the scene takes hold of the model. */
  holds(z_mm: number): boolean {
    const { original } = this.#session.model;
    const placement = this.#session.placement.value;
    if (original.value === null || placement === null) return false;
    const { high } = boxOf(placed(original.value.mesh.positions, placement));
    return z_mm > foot * high[2];
  }

  /** Takes hold at a height, with the pointer at a place of the viewport. */
  begin(viewport: Viewport, xPx: number, yPx: number, level_mm: number): void {
    const at = onLevel(viewport.rayThrough(xPx, yPx), level_mm);
    if (at === null) return;
    const [x, y] = this.#shift();
    this.#grab = { x: x - at[0], y: y - at[1], level_mm };
    dragging.value = true;
  }

  drag(viewport: Viewport, xPx: number, yPx: number): void {
    const grab = this.#grab;
    const at = grab && onLevel(viewport.rayThrough(xPx, yPx), grab.level_mm);
    if (at) this.#move(at[0] + grab.x, at[1] + grab.y);
  }

  end(): void {
    if (this.#grab === null) return;
    this.#grab = null;
    dragging.value = false;
    this.#session.services.projects.commit();
  }

  get holding(): boolean {
    return this.#grab !== null;
  }

  /** Takes an arrow key; false for other keys. */
  key(event: KeyboardEvent): boolean {
    const step = event.shiftKey ? leap_mm : step_mm;
    const by = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] }[
      event.key
    ];
    if (by === undefined || event.ctrlKey || event.altKey || event.metaKey) return false;
    const [x, y] = this.#shift();
    this.#move(x + (by[0] ?? 0), y + (by[1] ?? 0));
    return true;
  }

  #shift(): readonly [number, number] {
    return [Number(this.#session.value('x_mm') ?? 0), Number(this.#session.value('y_mm') ?? 0)];
  }

  #move(x: number, y: number): void {
    const values: Record<string, Json> = { x_mm: this.#within('x_mm', x), y_mm: this.#within('y_mm', y) };
    this.#session.setParameters(values, 'Move the model', 'place');
  }

  #within(name: string, value: number): number {
    const { minimum = -Infinity, maximum = Infinity } =
      this.#session.operation.value?.parameters.properties[name] ?? {};
    return millimetre(Math.min(maximum, Math.max(minimum, value)));
  }
}
