// SPDX-License-Identifier: GPL-3.0-or-later
// The time of a practice machine and of its driver: one for both, so that a run can go faster than the wall's clock without
// either noticing. Only machines that exist on the screen have one.

/** As fast as the page can. */
export const fastest = Infinity;

/** Driver and machine hear of each other this often in the machine's own time, at every speed: often enough that the
 *  machine does not run out of lines. */
const slice_s = 0.02;
/** A page that slept does not make up for it: the machine slept, too. */
const longest_gap_s = 1;
/** Of the worker's time at once, so that a stop is heard in between. */
const budget_s = 0.012;

export interface PracticeTime {
  /** Lets driver and machine act up to this moment of the machine's time. */
  act(now_s: number): void;
  /** Does the speed count now? What a person does by hand takes as long as on a real machine. */
  isFast(): boolean;
}

export class PracticeClock {
  readonly #wall_s: () => number;
  #wallBefore_s: number;
  #now_s: number;
  /** Seconds of the machine a second of the wall, while a job runs. */
  speed = 1;
  readonly #pace = { since_s: 0, machine_s: 0, value: 1 };

  constructor(wall_s: () => number) {
    this.#wall_s = wall_s;
    this.#wallBefore_s = this.#now_s = wall_s();
    this.#pace.since_s = this.#pace.machine_s = this.#now_s;
  }

  /** Never goes back, and never jumps: after `pass` it is where the last `act` was. */
  get now_s(): number {
    return this.#now_s;
  }

  /** Seconds of the machine a second of the wall, as they were in the last half second. */
  get pace(): number {
    return this.#pace.value;
  }

  /** Lets the time pass that has passed on the wall since the last call. What does not fit into the budget waits for the next call, up
   *  to a second of it: where the page cannot keep up, the machine is slower than it was asked to be. */
  pass({ act, isFast }: PracticeTime): void {
    const start_s = this.#wall_s();
    let left_s = Math.min(Math.max(0, start_s - this.#wallBefore_s), longest_gap_s);
    this.#wallBefore_s = start_s;
    while (left_s > 1e-6) {
      const speed = isFast() ? this.speed : 1;
      const step_s = Math.min(slice_s, left_s * speed);
      left_s -= step_s / speed;
      this.#now_s += step_s;
      act(this.#now_s);
      if (this.#wall_s() - start_s <= budget_s) continue;
      if (speed !== fastest) this.#wallBefore_s -= left_s;
      break;
    }
    this.#measurePace(start_s);
  }

  #measurePace(wall_s: number): void {
    const pace = this.#pace;
    const passed_s = wall_s - pace.since_s;
    if (passed_s < 0.5) return;
    // What lies further back than a sleep says nothing of the pace.
    if (passed_s < 2) pace.value = (this.#now_s - pace.machine_s) / passed_s;
    pace.since_s = wall_s;
    pace.machine_s = this.#now_s;
  }
}
