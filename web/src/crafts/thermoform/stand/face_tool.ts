// SPDX-License-Identifier: GPL-3.0-or-later
// The tool “Place on face”: the flat sides of the model's convex hull, and which of them is pointed at.
import { computed, effect, signal } from '@preact/signals';
import { createRef } from 'preact';
import type { FlatSide } from '../../../view';
import { prepareFlatSides } from '../../../view';
import type { ThermoformSession } from '../thermoform_session';
import { undersideIn } from './place_model';
import type { Vector } from '../../../shared/geometry/rotation';
import { placeOnSide } from './stand_model';

/** Normals closer than this are the same side's. */
const same = Math.cos((0.05 * Math.PI) / 180);
const dot = (a: Vector, b: Vector): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

export class FaceTool {
  /** The button that starts it, which has the focus again at the end. */
  readonly opener = createRef<HTMLButtonElement>();
  /** Null: the tool is not in use. The largest first. */
  readonly sides = signal<readonly FlatSide[] | null>(null);
  readonly finding = signal(false);
  /** The number of a side, by the pointer or in the list. */
  readonly pointed = signal<number | null>(null);
  /** The side that the model stands on now. */
  readonly underside = computed(() => {
    const down = undersideIn(this.#session.inForce.value);
    const at = down && this.sides.value?.findIndex(({ normal }) => dot(normal, down) > same);
    return at === null || at === undefined || at < 0 ? null : at;
  });
  readonly #session: ThermoformSession;
  #found: { readonly from: string; readonly sides: readonly FlatSide[] } | null = null;

  constructor(session: ThermoformSession) {
    this.#session = session;
  }

  /** Ends the tool where its model goes; returns what ends the watch. */
  watch(): () => void {
    let from: string | undefined;
    return effect(() => {
      const now = this.#session.model.original.value?.from;
      if (now !== from) this.#end();
      from = now;
    });
  }

  async toggle(): Promise<void> {
    if (this.sides.peek() !== null || this.finding.peek()) this.leave();
    else await this.#start();
  }

  async #start(): Promise<void> {
    const original = this.#session.model.original.peek();
    if (original === null) return;
    const { from, mesh } = original;
    if (this.#found?.from !== from) {
      this.finding.value = true;
      const sides = await prepareFlatSides(mesh.positions).catch(() => []);
      if (!this.finding.peek() || this.#session.model.original.peek()?.from !== from) return;
      this.#found = { from, sides };
    }
    this.finding.value = false;
    this.sides.value = this.#found.sides;
    this.pointed.value = null;
  }

  take(index: number | null): void {
    const side = index === null ? undefined : this.sides.peek()?.[index];
    if (side === undefined) return;
    placeOnSide(this.#session, side.normal);
    this.leave();
  }

  leave(): void {
    this.#end();
    this.opener.current?.focus();
  }

  #end(): void {
    this.finding.value = false;
    this.sides.value = null;
    this.pointed.value = null;
  }
}
