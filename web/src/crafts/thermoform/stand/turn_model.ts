// SPDX-License-Identifier: GPL-3.0-or-later
// Turning and tilting the model by its rings, by hand and by keys.
import { computed, signal } from '@preact/signals';
import type { JsonObject } from '../../../jobs/contract';
import type { Viewport } from '../../../view';
import type { Box } from '../placement';
import { boxOf, placed } from '../placement';
import type { ThermoformSession } from '../thermoform_session';
import { dragging } from '../views';
import { rotationIn } from './place_model';
import type { Handle, Ring } from './ring';
import { angleSeen, pointOn, ringAround } from './ring';
import type { Rotation } from '../../../shared/geometry/rotation';
import { about, after } from '../../../shared/geometry/rotation';
import { withinHalfTurn } from './stance';
import { standBy } from './stand_model';

export const snap_deg = 15;
const fine_deg = 1;

export const actions: Readonly<Record<Handle, string>> = {
  turn: 'Turn the model',
  sideways: 'Tilt the model sideways',
  forwards: 'Tilt the model to the front or back',
};

interface Grab {
  readonly handle: Handle;
  readonly ring: Ring;
  readonly values: JsonObject;
  readonly rotation: Rotation;
  /** The angle of a pointer, whatever its zero. */
  readonly angleOf: (viewport: Viewport, xPx: number, yPx: number) => number | null;
  readonly from_deg: number;
}

export class ModelTurner {
  /** What the hand holds, and how far it has turned it, degrees. */
  readonly held = signal<{ readonly handle: Handle; readonly ring: Ring; readonly by_deg: number } | null>(
    null,
  );
  /** The handle that is pointed at or has the focus. */
  readonly near = signal<Handle | null>(null);
  /** Of the model as it stands now. */
  readonly box = computed((): Box | null => {
    const original = this.#session.model.original.value;
    const placement = this.#session.placement.value;
    return original && placement && boxOf(placed(original.mesh.positions, placement));
  });
  readonly #session: ThermoformSession;
  #grab: Grab | null = null;

  constructor(session: ThermoformSession) {
    this.#session = session;
  }

  /** Around the model as it stands now; null where there is none. */
  ring(handle: Handle): Ring | null {
    const box = this.box.value;
    return box && ringAround(box, handle);
  }

  begin(viewport: Viewport, handle: Handle, xPx: number, yPx: number): void {
    const ring = this.ring(handle);
    const values = this.#session.inForce.peek();
    const rotation = rotationIn(values);
    if (ring === null || rotation === null) return;
    const angleOf = angleFinder(viewport, ring, xPx, yPx);
    const from_deg = angleOf(viewport, xPx, yPx);
    if (from_deg === null) return;
    this.#grab = { handle, ring, values, rotation, angleOf, from_deg };
    this.held.value = { handle, ring, by_deg: 0 };
    dragging.value = true;
  }

  /** `free`: to the degree, rather than in steps of 15. */
  drag(viewport: Viewport, xPx: number, yPx: number, free: boolean): void {
    const grab = this.#grab;
    const at = grab?.angleOf(viewport, xPx, yPx) ?? null;
    if (grab === null || at === null) return;
    const by = withinHalfTurn(at - grab.from_deg);
    const start = grab.handle === 'turn' ? Number(grab.values['turn_deg'] ?? 0) : 0;
    const step = free ? fine_deg : snap_deg;
    const by_deg = step * Math.round((start + by) / step) - start;
    if (by_deg === this.held.peek()?.by_deg) return;
    this.held.value = { handle: grab.handle, ring: grab.ring, by_deg };
    this.#apply(grab, by_deg);
  }

  end(): void {
    if (this.#grab === null) return;
    this.#grab = null;
    this.held.value = null;
    dragging.value = false;
    this.#session.services.projects.commit();
  }

  get holding(): boolean {
    return this.#grab !== null;
  }

  /** Takes an arrow key; false for other keys. */
  key(event: KeyboardEvent, handle: Handle): boolean {
    const [less, more] = handle === 'forwards' ? ['ArrowUp', 'ArrowDown'] : ['ArrowLeft', 'ArrowRight'];
    if (event.ctrlKey || event.altKey || event.metaKey || (event.key !== less && event.key !== more))
      return false;
    const values = this.#session.inForce.peek();
    const rotation = rotationIn(values);
    if (rotation === null) return false;
    const sign = event.key === more ? 1 : -1;
    const step = event.shiftKey ? fine_deg : snap_deg;
    const start = handle === 'turn' ? Number(values['turn_deg'] ?? 0) : 0;
    // To the next whole step: from 7 degrees to 15 or 0.
    const to = sign * step * (Math.floor((sign * start) / step + 1e-9) + 1);
    this.#apply({ handle, values, rotation }, to - start);
    return true;
  }

  #apply({ handle, values, rotation }: Pick<Grab, 'handle' | 'values' | 'rotation'>, by_deg: number): void {
    if (handle === 'turn') {
      const turn_deg = Number(withinHalfTurn(Number(values['turn_deg'] ?? 0) + by_deg).toFixed(6));
      this.#session.setParameters({ turn_deg }, actions.turn, 'turn');
      return;
    }
    const axis = handle === 'sideways' ? ([0, 1, 0] as const) : ([1, 0, 0] as const);
    standBy(this.#session, values, after(about(axis, by_deg), rotation), actions[handle], 'tilt');
  }
}

/** Where the ring is seen from its edge, the pointer's way along it counts instead of its angle. */
function angleFinder(viewport: Viewport, ring: Ring, xPx: number, yPx: number): Grab['angleOf'] {
  if (angleSeen(ring, viewport.rayThrough(xPx, yPx)) !== null)
    return (view, x, y) => angleSeen(ring, view.rayThrough(x, y));
  const span_deg = 10;
  const [a, b] = [-span_deg, span_deg].map((by) => viewport.project(pointOn(ring, ring.rest_deg + by)));
  if (!a || !b) return () => null;
  const [alongX, alongY] = [(b.xPx - a.xPx) / (2 * span_deg), (b.yPx - a.yPx) / (2 * span_deg)];
  const square = Math.max(alongX ** 2 + alongY ** 2, 0.25); // at least half a pixel for each degree
  return (_, x, y) => ((x - xPx) * alongX + (y - yPx) * alongY) / square;
}
