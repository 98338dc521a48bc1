// SPDX-License-Identifier: GPL-3.0-or-later
import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import type { Film } from '../../jobs/glb';
import { fractionAt, momentAt, phaseAt, phasesOf, sheetAt, Stretching, timeAt } from './film';

/** One square of two triangles that grows to twice its width. */
const flat = Float32Array.of(0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0);
const film: Film = {
  indices: Uint32Array.of(0, 1, 2, 0, 2, 3),
  frames: [
    flat,
    flat,
    flat.map((x, i) => (i % 3 === 2 ? 1 : x)),
    flat.map((x, i) => (i % 3 === 0 ? 2 * x : x)),
  ],
  times_s: [0, 1, 2, 2.1],
  phases: ['relax', 'relax', 'raise', 'vacuum'],
  platform_z_mm: [-100, -100, 0, 0],
  touching_share: [0, 0, 0.5, 1],
};

describe('a moment of the film', () => {
  it('lies between two frames', () => {
    const moment = momentAt(film, 1.25);
    expect(moment).toMatchObject({
      frame: 1,
      share: 0.25,
      platform_z_mm: -75,
      touching_share: 0.125,
    });
    expect([...sheetAt(film, moment)].filter((_, i) => i % 3 === 2)).toEqual([0.25, 0.25, 0.25, 0.25]);
  });

  it('begins with the first frame and ends with the last', () => {
    expect(sheetAt(film, momentAt(film, -1))).toEqual(film.frames[0]);
    expect(sheetAt(film, momentAt(film, 99))).toEqual(film.frames[3]);
  });

  it('knows how far each place has stretched', () => {
    const stretching = new Stretching(film);
    expect([...stretching.at(flat)]).toEqual([1, 1, 1, 1]);
    expect([...stretching.at(sheetAt(film, momentAt(film, 2.1)))]).toEqual([2, 2, 2, 2]);
  });
});

describe('the timeline', () => {
  // The core says where a phase ends; its frames need not lie there.
  const phases = phasesOf(film, { relax: 1.2, raise: 2 });

  it('has the phases one after the other, none too narrow for its words', () => {
    expect(phases.map(({ name, start_s, end_s }) => [name, start_s, end_s])).toEqual([
      ['relax', 0, 1.2],
      ['raise', 1.2, 2],
      ['vacuum', 2, 2.1],
    ]);
    expect(phases.map(({ from, to }) => [from, to].map((x) => Number(x.toFixed(6))))).toEqual([
      [0, 0.48],
      [0.48, 0.8],
      [0.8, 1],
    ]);
  });

  it('goes from times to places and back', () => {
    fc.assert(
      fc.property(fc.double({ min: 0, max: 2.1, noNaN: true }), (time) => {
        const at = fractionAt(phases, time);
        expect(at).toBeGreaterThanOrEqual(0);
        expect(at).toBeLessThanOrEqual(1);
        expect(timeAt(phases, at)).toBeCloseTo(time, 9);
      }),
    );
    expect(timeAt(phases, -3)).toBe(0);
    expect(timeAt(phases, 3)).toBeCloseTo(2.1);
    expect(fractionAt(phases, 99)).toBe(1);
  });

  it('knows the phase of a moment', () => {
    expect([0, 1.2, 1.3, 2, 2.05, 9].map((time) => phaseAt(phases, time))).toEqual([
      'relax',
      'relax',
      'raise',
      'raise',
      'vacuum',
      'vacuum',
    ]);
  });

  it('grows with time', () => {
    fc.assert(
      fc.property(fc.double({ min: 0, max: 2, noNaN: true }), (time) => {
        expect(fractionAt(phases, time + 0.1)).toBeGreaterThan(fractionAt(phases, time));
      }),
    );
  });

  it('of one phase is all of it', () => {
    const one = phasesOf({ ...film, phases: ['vacuum', 'vacuum', 'vacuum', 'vacuum'] });
    expect(one).toEqual([{ name: 'vacuum', start_s: 0, end_s: 2.1, from: 0, to: 1 }]);
  });
});
