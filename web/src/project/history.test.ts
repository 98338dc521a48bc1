// SPDX-License-Identifier: GPL-3.0-or-later
import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import type { Json, JsonObject } from '../jobs/contract';
import { difference, joinChanges, redoChanges, undoChanges } from './changes';
import { jsonEqual } from './document';
import type { Command } from './history';
import { History } from './history';

// Small keys and shallow trees, so that random documents overlap often; __proto__ must be a key like any other.
const key = fc.constantFrom('a', 'b', 'c', '__proto__', 'constructor');
const { tree } = fc.letrec<{ tree: Json; leaf: Json; object: JsonObject }>((tie) => ({
  leaf: fc.oneof(
    fc.constant(null),
    fc.boolean(),
    fc.integer({ min: -3, max: 3 }),
    fc.array(fc.integer({ min: 0, max: 2 }), { maxLength: 2 }),
  ),
  object: fc
    .array(fc.tuple(key, tie('tree')), { maxLength: 4 })
    .map((entries) => Object.fromEntries(entries) as JsonObject),
  tree: fc.oneof({ depthSize: 'small', maxDepth: 3 }, tie('leaf'), tie('object')),
}));
const documents = fc
  .array(fc.tuple(key, tree), { maxLength: 4 })
  .map((entries) => Object.fromEntries(entries) as JsonObject);
const put = (document: JsonObject): Command<JsonObject> => ({ label: 'put', apply: () => document });

describe('changes', () => {
  it('redo makes the second document of the first, undo the first of the second', () => {
    fc.assert(
      fc.property(documents, documents, (a, b) => {
        const changes = difference(a, b);
        expect(jsonEqual(redoChanges(a, changes), b)).toBe(true);
        expect(jsonEqual(undoChanges(b, changes), a)).toBe(true);
        expect(changes.length === 0).toBe(jsonEqual(a, b));
      }),
    );
  });

  it('two slider steps joined are one step from the first to the last', () => {
    const numbers = fc.record({ x: fc.integer(), y: fc.integer() });
    fc.assert(
      fc.property(numbers, numbers, numbers, (a, b, c) => {
        const joined = joinChanges(difference(a, b), difference(b, c));
        expect(redoChanges(a, joined)).toEqual(c);
        expect(undoChanges(c, joined)).toEqual(a);
      }),
    );
  });
});

describe('History', () => {
  it('undo after do is the identity, for any sequence', () => {
    fc.assert(
      fc.property(documents, fc.array(documents, { maxLength: 8 }), (start, others) => {
        const history = new History(start);
        const passed: JsonObject[] = [start];
        for (const other of others) if (history.do(put(other))) passed.push(other);
        const last = passed.at(-1) as JsonObject;
        for (const expected of passed.slice(0, -1).reverse()) {
          expect(history.undo()).toBe(true);
          expect(jsonEqual(history.document, expected)).toBe(true);
        }
        expect(history.undo()).toBe(false);
        while (history.redo());
        expect(jsonEqual(history.document, last)).toBe(true);
      }),
    );
  });

  it('what is not recorded survives undo and redo', () => {
    const history = new History<JsonObject>({ thickness: 5, results: [] });
    history.do({ label: 'a', apply: (d) => ({ ...d, thickness: 7 }) });
    history.do({ label: 'result', recorded: false, apply: (d) => ({ ...d, results: ['solved'] }) });
    history.undo();
    expect(history.document).toEqual({ thickness: 5, results: ['solved'] });
    history.redo();
    expect(history.document).toEqual({ thickness: 7, results: ['solved'] });
  });

  it('a slider dragged is one step, two drags are two', () => {
    const history = new History<JsonObject>({ x: 0 });
    const drag = (to: number) => history.do({ label: 'x', coalesce: 'x', apply: (d) => ({ ...d, x: to }) });
    for (let i = 1; i <= 20; ++i) drag(i);
    history.commit();
    for (let i = 21; i <= 40; ++i) drag(i);
    history.undo();
    expect(history.document).toEqual({ x: 20 });
    history.undo();
    expect(history.document).toEqual({ x: 0 });
    expect(history.undoLabel).toBeNull();
  });

  it('a slider dragged back to where it was leaves no step', () => {
    const history = new History<JsonObject>({ x: 0 });
    for (const to of [1, 2, 0]) history.do({ label: 'x', coalesce: 'x', apply: (d) => ({ ...d, x: to }) });
    expect(history.undoLabel).toBeNull();
  });

  it('a new command ends what could be redone', () => {
    const history = new History<JsonObject>({ x: 0 });
    history.do(put({ x: 1 }));
    history.undo();
    history.do(put({ x: 2 }));
    expect(history.redo()).toBe(false);
  });
});
