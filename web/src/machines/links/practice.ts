// SPDX-License-Identifier: GPL-3.0-or-later
// A virtual machine in its own time. While a job moves on, that time may run faster; everything done by hand takes as long as on
// a real machine: homing, jogs, focus, pauses, a stop.
import type { VirtualEnd } from './machine_ends';
import type { MachineState } from './machine_state';
import { PracticeClock } from './practice_clock';

const tick_s = 0.05;
const atRest: readonly string[] = ['paused', 'door', 'alarm', 'sleep'];

/** Does the machine work off a job now? */
const movesOn = ({ job, phase }: MachineState): boolean =>
  job !== null && job.ended === null && !atRest.includes(phase);

export class Practice {
  readonly #clock: PracticeClock;
  readonly #wall_s: () => number;
  #ticked_s = 0;
  /** When z was set to 0: in the machine's time, and on the wall. */
  #zSet: { readonly machine_s: number; readonly wall_s: number } | null = null;

  constructor(wall_s: () => number) {
    this.#wall_s = wall_s;
    this.#clock = new PracticeClock(wall_s);
  }

  get now_s(): number {
    return this.#clock.now_s;
  }
  /** Seconds of the machine a second of the wall, as measured. */
  get pace(): number {
    return this.#clock.pace;
  }
  set speed(speed: number) {
    if (!(speed >= 1)) throw new Error('A practice machine runs at its own speed or faster.');
    this.#clock.speed = speed;
  }

  /** Lets time pass for the machine and its driver, in turn. */
  pass(end: VirtualEnd, tick: () => void, state: () => MachineState | null): void {
    this.#clock.pass({
      act: (now_s) => {
        end.advance(now_s);
        if (now_s - this.#ticked_s < tick_s) return;
        this.#ticked_s = now_s;
        tick();
      },
      isFast: () => {
        const said = state();
        return said !== null && movesOn(said);
      },
    });
  }

  /** As a person should see it: how long ago z was set is said by the wall's clock, which shows the time of day. */
  onWall(state: MachineState): MachineState {
    const { z_choice } = state;
    const ago_s = z_choice?.set_seconds_ago ?? null;
    if (z_choice === null || ago_s === null) return state;
    const machine_s = this.now_s - ago_s;
    if (this.#zSet === null || Math.abs(this.#zSet.machine_s - machine_s) > 1e-3)
      this.#zSet = { machine_s, wall_s: this.#wall_s() - ago_s };
    const set_seconds_ago = this.#wall_s() - this.#zSet.wall_s;
    return { ...state, z_choice: { ...z_choice, set_seconds_ago } };
  }
}
