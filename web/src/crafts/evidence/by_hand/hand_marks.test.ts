// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { ByHand, HandMark } from './hand_marks';
import { lengthIn } from '../../../shared/diagnosis/length_in';
import {
  expectedAt,
  fromOrigin,
  marksIn,
  measuredMarks,
  measuredTable,
  outlooksIn,
  placeOf,
  problemOf,
} from './hand_marks';

const opening = [220, 240] as const;
const mark = (x: string, y: string, z: string): HandMark => ({
  sheet_mm: [-30, 50],
  expected_mm: [-29, 48.5, 16],
  typed: [x, y, z],
});
const byHand = (...marks: HandMark[]): ByHand => ({
  mould: { kind: 'sample', sample: 'pyramid', title: 'Pyramid' },
  parameters: {},
  origin: 'corner',
  marks,
  plan: null,
});

describe('marks measured by hand', () => {
  it('reads lengths as people write them', () => {
    expect(lengthIn(' 12.5 ')).toBe(12.5);
    expect(lengthIn('12,5')).toBe(12.5);
    expect(lengthIn('−3')).toBe(-3);
    for (const text of ['', '12 mm', '1e3', '1.2.3', 'NaN']) expect(lengthIn(text)).toBeNull();
  });

  it('counts from the corner of the opening or from its middle', () => {
    expect(placeOf(mark('80', '168', '16.2'), 'corner', opening)).toEqual([-30, 48, 16.2]);
    expect(placeOf(mark('-30', '48', '16.2'), 'middle', opening)).toEqual([-30, 48, 16.2]);
    expect(expectedAt(mark('', '', ''), 'corner', opening)).toEqual([81, 168.5, 16]);
    const typed = [mark('80.3', '168', 'x')];
    const there = fromOrigin(typed, 'corner', 'middle', opening);
    expect(there[0]?.typed).toEqual(['-29.7', '48', 'x']);
    expect(fromOrigin(there, 'middle', 'corner', opening)).toEqual(typed);
  });

  it('says what is wrong with a mark', () => {
    const say = (...typed: [string, string, string]) => problemOf(mark(...typed), 'corner', opening);
    expect(say('', '', '')).toBe('');
    expect(say('80', '168', '16.2')).toBe('');
    expect(say('80', '', '')).toContain('Measure x, y and z');
    expect(say('8o', '168', '16')).toContain('“8o”');
    expect(say('180', '168', '16')).toContain('99 mm from where it is expected');
  });

  it('makes a table of what was measured alone', () => {
    const some = byHand(mark('80', '168', '16.2'), mark('', '', ''), mark('80', '168', ''));
    expect(measuredMarks(some, opening)).toHaveLength(1);
    expect(measuredTable(some, opening, 0.3)).toBe(
      'sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,sigma_mm\n-30,50,-30,48,16.2,0.3\n',
    );
    const rim = [{ side: 'left', sheet_mm: [-115, 0] as const, expected_mm: 1, typed: '1.1' }];
    expect(measuredTable({ ...some, rim }, opening, 0.3)).toBe(
      'sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,sigma_mm,thickness_mm,thickness_sigma_mm\n' +
        '-30,50,-30,48,16.2,0.3,,\n-115,0,,,,,1.1,0\n',
    );
  });

  it('reads marks and outlooks of a report, and nothing of a broken one', () => {
    const place = {
      sheet_x_mm: -30,
      sheet_y_mm: 50,
      expected_x_mm: -29,
      expected_y_mm: 48.5,
      expected_z_mm: 16,
    };
    expect(marksIn({ marks: [{ number: 1, ...place }, { number: 2 }, 3] })).toEqual([mark('', '', '')]);
    const cause = { label: 'A', unit: '', usual_strength: 0.3, best_visible_strength: 0.1 };
    const listed = outlooksIn({
      causes: [
        { ...cause, name: 'hidden', shows: false, min_visible_strength: null },
        { ...cause, name: 'shown', shows: true, min_visible_strength: 0.2 },
        'x',
      ],
    });
    expect(listed.map(({ name, visibleFrom }) => [name, visibleFrom])).toEqual([
      ['shown', 0.2],
      ['hidden', null],
    ]);
    expect(marksIn({})).toEqual([]);
    expect(outlooksIn({ causes: 5 })).toEqual([]);
  });
});
