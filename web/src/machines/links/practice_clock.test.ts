// SPDX-License-Identifier: GPL-3.0-or-later
import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { fastest, PracticeClock } from './practice_clock';

/** A wall clock that the test moves; looking at it takes `look_s`. */
class Wall {
  now_s = 1000;
  look_s = 0;
  read = () => (this.now_s += this.look_s);
}
const follow = (clock: PracticeClock, isFast = () => true) => {
  const times: number[] = [];
  clock.pass({ act: (now_s) => void times.push(now_s), isFast });
  return times;
};
/** Lets so many seconds pass in portions of 20 ms, as the runner does. */
function pass(clock: PracticeClock, wall: Wall, seconds: number, isFast = () => true): number[] {
  const times: number[] = [];
  for (let k = 0; k < Math.round(seconds / 0.02); ++k) {
    wall.now_s += 0.02;
    times.push(...follow(clock, isFast));
  }
  return times;
}

describe('the time of a practice machine', () => {
  it('is the wall’s at first, and runs as many times faster as its speed says', () => {
    const wall = new Wall();
    const clock = new PracticeClock(wall.read);
    expect(clock.now_s).toBe(wall.now_s);
    pass(clock, wall, 2);
    expect(clock.now_s).toBeCloseTo(1002, 6);
    expect(clock.pace).toBeCloseTo(1, 6);
    clock.speed = 16;
    pass(clock, wall, 2);
    expect(clock.now_s).toBeCloseTo(1034, 6);
    expect(clock.pace).toBeCloseTo(16, 6);
  });

  it('neither jumps nor goes back, whatever the speeds, the gaps and the moments of their change', () => {
    const speed = fc.constantFrom(1, 4, 16, fastest);
    const step = fc.record({ speed, gap_s: fc.double({ min: -1, max: 5, noNaN: true }), fast: fc.boolean() });
    fc.assert(
      fc.property(fc.array(step, { maxLength: 40 }), (steps) => {
        const wall = new Wall();
        wall.look_s = 1e-4;
        const clock = new PracticeClock(wall.read);
        let before_s = clock.now_s;
        for (const { speed, gap_s, fast } of steps) {
          clock.speed = speed;
          expect(clock.now_s).toBe(before_s); // the change itself takes no time
          wall.now_s += gap_s;
          for (const now_s of follow(clock, () => fast)) {
            expect(now_s).toBeGreaterThan(before_s);
            expect(now_s - before_s).toBeLessThanOrEqual(0.02 + 1e-9); // both sides of the line hear of each other
            before_s = now_s;
          }
          expect(clock.now_s).toBe(before_s);
        }
      }),
    );
  });

  it('is the wall’s while nothing but a person moves the machine', () => {
    const wall = new Wall();
    const clock = new PracticeClock(wall.read);
    clock.speed = fastest;
    pass(clock, wall, 1, () => false);
    expect(clock.now_s).toBeCloseTo(1001, 6);
    // A job that ends within a portion takes the speed with it.
    wall.now_s += 0.02;
    let left = 5;
    clock.pass({ act: () => void --left, isFast: () => left > 0 });
    expect(clock.now_s).toBeCloseTo(1001 + 5 * 0.02 + 0.02, 6);
  });

  it('stands still while the page sleeps', () => {
    const wall = new Wall();
    const clock = new PracticeClock(wall.read);
    wall.now_s += 3600;
    follow(clock);
    expect(clock.now_s - 1000).toBeCloseTo(1, 6);
  });

  it('makes up for a moment in which the page was busy', () => {
    const wall = new Wall();
    wall.look_s = 0.001;
    const clock = new PracticeClock(wall.read);
    wall.now_s += 0.8;
    follow(clock);
    expect(clock.now_s - 1000).toBeLessThan(0.5); // as much as fits into one turn
    pass(clock, wall, 1);
    expect(Math.abs(clock.now_s - wall.now_s)).toBeLessThan(0.05);
  });

  it('is slower than its speed where the page cannot keep up, so that a stop is heard', () => {
    const wall = new Wall();
    wall.look_s = 0.002; // what a slice costs
    const clock = new PracticeClock(wall.read);
    for (const speed of [16, fastest]) {
      clock.speed = speed;
      wall.now_s += 0.2;
      const start_s = wall.now_s;
      expect(follow(clock).length).toBeGreaterThan(1);
      expect(wall.now_s - start_s).toBeLessThan(0.02);
    }
    pass(clock, wall, 2);
    expect(clock.pace).toBeGreaterThan(1);
    expect(clock.pace).toBeLessThan(100);
  });
});
