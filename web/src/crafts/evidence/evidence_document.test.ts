// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { ProjectDocument } from '../../project/document';
import { blobsOf, newDocument } from '../../project/document';
import { History } from '../../project/history';
import type { MeasuredObject } from './evidence_document';
import { emptyEvidence, evidence, freeName, subjectOf, usesIn } from './evidence_document';

const blob = (digit: string) => ({ blob: digit.repeat(64), bytes: 1, media_type: 'x' });
const object = (name: string, digit: string, use: MeasuredObject['use'] = 'fit'): MeasuredObject => ({
  id: name,
  name,
  pack: blob(digit),
  files: { 'mould.obj': blob('1'), 'setup.json': blob('2'), 'measured.csv': blob('3') },
  points: 100,
  use,
});
const lamp = object('lamp', 'a');
const box = object('box', 'b');
const bowl = object('bowl', 'c', 'unseen');

describe('evidence in a project', () => {
  it('asks for the objects that are used, and measures the gain on others', () => {
    const subject = subjectOf({ mode: 'diagnose', objects: [lamp, bowl, box] });
    expect(Object.keys(subject?.inputs ?? {})).toEqual(['object', 'object_2', 'unseen']);
    expect(subject?.inputs['object_2']).toEqual({ sha256: box.pack.blob, file_name: 'box.zip' });
    const calibration = subjectOf({ mode: 'calibrate', objects: [lamp, bowl, box] });
    expect(Object.keys(calibration?.inputs ?? {})).toEqual(['object', 'object_2']);
    expect(calibration?.key).not.toBe(subject?.key);
    expect(subjectOf({ mode: 'diagnose', objects: [bowl] })).toBeNull();
  });

  it('finds back what a result used each object for', () => {
    const key = subjectOf({ mode: 'diagnose', objects: [lamp, bowl] })?.key ?? '';
    const now = [{ ...lamp, use: 'off' as const }, bowl, box];
    const then = usesIn(key, now);
    expect(then?.mode).toBe('diagnose');
    expect(then?.objects.map(({ use }) => use)).toEqual(['fit', 'unseen', 'off']);
    expect(subjectOf({ mode: 'diagnose', objects: then?.objects ?? [] })?.key).toBe(key);
    expect(usesIn(key, [bowl, box])).toBeNull();
  });

  it('compares with a good part, and finds it back', () => {
    const june = object('June', 'd', 'good');
    const subject = subjectOf({ mode: 'diagnose', objects: [lamp, bowl, june] });
    expect(Object.keys(subject?.inputs ?? {})).toEqual(['object', 'unseen', 'good']);
    const then = usesIn(
      subject?.key ?? '',
      [june, lamp, bowl].map((one) => ({ ...one, use: 'off' as const })),
    );
    expect(then?.objects.map(({ use }) => use)).toEqual(['good', 'fit', 'unseen']);
    expect(usesIn(subject?.key ?? '', [lamp, bowl])).toBeNull();
    // Results from before there were good parts are known by the same key.
    expect(subjectOf({ mode: 'diagnose', objects: [lamp, bowl] })?.key.split(' ')).toHaveLength(3);
    expect(Object.keys(subjectOf({ mode: 'calibrate', objects: [lamp, june] })?.inputs ?? {})).toEqual([
      'object',
    ]);
  });

  it('takes back and repeats what was done with objects; results stay', () => {
    const history = new History<ProjectDocument>(newDocument('1', 'One', 0));
    history.do(evidence.addObject(lamp));
    history.do(evidence.addObject(bowl));
    history.do(evidence.useObject(bowl, 'fit'));
    const key = subjectOf(evidence.of(history.document))?.key ?? '';
    history.do(
      evidence.addResult({
        id: 'r',
        made_unix_s: 0,
        backend: 'wasm',
        seconds: 1,
        mesh: key,
        parameters: {},
        report: {},
        outputs: {},
      }),
    );
    history.undo();
    expect(evidence.of(history.document).objects.map(({ use }) => use)).toEqual(['fit', 'unseen']);
    history.undo();
    expect(evidence.of(history.document).objects).toEqual([lamp]);
    expect(evidence.of(history.document).results).toHaveLength(1);
    history.redo();
    history.redo();
    expect(subjectOf(evidence.of(history.document))?.key).toBe(key);
    history.do(evidence.removeObject(lamp));
    expect(evidence.of(history.document).objects.map(({ name }) => name)).toEqual(['bowl']);
  });

  it('names every file it needs, so that none is swept away', () => {
    const document = evidence.addObject(lamp).apply(newDocument('1', 'One', 0));
    expect(blobsOf(document)).toEqual(new Set(['a', '1', '2', '3'].map((digit) => digit.repeat(64))));
  });

  it('tells objects of the same name apart', () => {
    expect(freeName('lamp', [])).toBe('lamp');
    expect(freeName('lamp', [lamp, object('lamp 2', 'd')])).toBe('lamp 3');
    expect(freeName('a,"b"', [])).toBe('a__b_');
  });

  it('opens projects from before it', () => {
    expect(evidence.of(newDocument('1', 'One', 0))).toEqual(emptyEvidence);
  });
});
