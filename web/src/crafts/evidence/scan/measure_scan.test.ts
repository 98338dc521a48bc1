// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { Scan } from '../evidence_document';
import { evidence } from '../evidence_document';
import { newDocument } from '../../../project/document';
import { cornersText, cornersToMove, firstCorners, measuredNow, moved, seenCorners } from './measure_scan';
import { arePhotographs, photographInputs, scanInputs } from './scan_files';

const blob = (digit: string) => ({ blob: digit.repeat(64), bytes: 1, media_type: 'x' });

describe('a scan on its way to points', () => {
  it('has corners in the order and words that the operation wants', () => {
    const corners = firstCorners(1000, 500);
    expect(cornersText(corners)).toBe('120,440 880,440 880,60 120,60');
    expect(cornersText(moved(corners, 2, [10.26, 0], [1000, 500]))).toBe('120,440 880,440 890.3,60 120,60');
    expect(moved(corners, 0, [-500, 500], [1000, 500])[0]).toEqual([0, 500]);
  });

  it('goes on by hand from the corners that were found', () => {
    const seen = seenCorners({ report: { corner_px: [[10.5, 20], null, [30, 'x'], [40, 50]] } });
    expect(seen).toEqual([[10.5, 20], null, null, [40, 50]]);
    expect(cornersToMove(seen, [1000, 500])).toEqual([
      [10.5, 20],
      [880, 440],
      [880, 60],
      [40, 50],
    ]);
    expect(seenCorners({ report: {} })).toEqual([null, null, null, null]);
  });

  it('forgets what was measured as soon as a corner moves, and finds it again', () => {
    const scan: Scan = {
      files: [{ input: 'scan', file_name: 'a.obj', file: blob('a') }],
      corners: firstCorners(100, 100),
      parameters: {},
      measured: null,
    };
    const of = {
      files: [['scan', 'a'.repeat(64)]],
      parameters: { corners: cornersText(scan.corners ?? []) },
    };
    let document = evidence.setScan(scan, 'Open').apply(newDocument('1', 'One', 0));
    const measured = { of, report: {}, points: blob('b'), aligned: blob('c') };
    document = evidence.keepMeasuredScan(measured).apply(document);
    const now = () => evidence.of(document).scan as Scan;
    expect(measuredNow(now())).toEqual(measured);
    const before = now().corners ?? [];
    document = evidence.changeScan({ corners: moved(before, 1, [1, 0], [100, 100]) }, 'Move').apply(document);
    expect(measuredNow(now())).toBeNull();
    document = evidence.changeScan({ corners: before }, 'Move').apply(document);
    expect(measuredNow(now())).toEqual(measured);
  });

  it('gives each file to the input that takes it', () => {
    const takes = (name: string, extensions: string[]) => ({ name, label: name, extensions });
    const operation = {
      name: 'evidence-register',
      title: '',
      inputs: [takes('scan', ['obj', 'glb']), takes('pattern', ['json']), takes('texture', ['png', 'jpg'])],
      parameters: { properties: {} },
      outputs: [],
    };
    const files = ['a.OBJ', 'pattern.json', 'a.png', 'a.txt'].map((name) => new File([''], name));
    expect(scanInputs(files, operation).map(({ input, file }) => [input, file.name])).toEqual([
      ['scan', 'a.OBJ'],
      ['pattern', 'pattern.json'],
      ['texture', 'a.png'],
    ]);
    expect(scanInputs(files, undefined)).toEqual([]);
  });
});

describe('photographs on their way to points', () => {
  const files = ['pattern.json', 'a.jpg', 'b.JPG', 'c.png', 'd.txt'].map((name) => new File([''], name));

  it('are numbered after those that are there', () => {
    const names = (before: number) =>
      photographInputs(files, before).map(({ input, file }) => [input, file.name]);
    expect(names(0)).toEqual([
      ['photograph', 'a.jpg'],
      ['photograph_2', 'b.JPG'],
      ['photograph_3', 'c.png'],
      ['pattern', 'pattern.json'],
    ]);
    expect(names(2)[0]).toEqual(['photograph_3', 'a.jpg']);
  });

  it('are distinguished from the picture of a scan', () => {
    const none = { photographs: false, scan: false };
    expect(arePhotographs(files, none)).toBe(true);
    expect(arePhotographs([{ name: 'a.obj' }, ...files], none)).toBe(false);
    expect(arePhotographs([{ name: 'a.jpg' }], none)).toBe(false);
    expect(arePhotographs([{ name: 'a.jpg' }], { photographs: true, scan: false })).toBe(true);
    expect(arePhotographs(files, { photographs: false, scan: true })).toBe(false);
  });
});
