// SPDX-License-Identifier: GPL-3.0-or-later
// Undo and redo over an immutable document. Commands with the same `coalesce` key that follow one
// another (a slider being dragged) are one step until `commit`.
import type { Json } from '../jobs/contract';
import type { Change } from './changes';
import { difference, joinChanges, redoChanges, undoChanges } from './changes';

export interface Command<T> {
  /** In the words of the undo button: "Change thickness". */
  readonly label: string;
  apply(document: T): T;
  readonly coalesce?: string;
  /** False for what is not the maker's doing, such as a result that arrives; it cannot be undone. */
  readonly recorded?: boolean;
}

interface Step {
  readonly label: string;
  readonly changes: readonly Change[];
  readonly coalesce: string | null;
}

const longestHistory = 500;

export class History<T> {
  #document: T;
  #done: Step[] = [];
  #undone: Step[] = [];

  constructor(document: T) {
    this.#document = document;
  }

  get document(): T {
    return this.#document;
  }
  /** The document, and whatever undo and redo can bring back, each value under its own name. */
  *values(): Generator<unknown> {
    yield this.#document;
    for (const { changes } of [...this.#done, ...this.#undone])
      for (const { path, before, after } of changes)
        for (const value of [before, after]) yield { [path.at(-1) ?? '']: value };
  }
  /** Label of what undo would take back, or null. */
  get undoLabel(): string | null {
    return this.#done.at(-1)?.label ?? null;
  }
  get redoLabel(): string | null {
    return this.#undone.at(-1)?.label ?? null;
  }

  /** Returns whether anything changed. */
  do(command: Command<T>): boolean {
    const after = command.apply(this.#document);
    const changes = difference(this.#document as Json, after as Json);
    if (changes.length === 0) return false;
    this.#document = after;
    if (command.recorded === false) return true;
    this.#undone = [];
    const coalesce = command.coalesce ?? null;
    const last = this.#done.at(-1);
    if (coalesce !== null && last?.coalesce === coalesce) {
      const joined = joinChanges(last.changes, changes);
      this.#done.pop();
      if (joined.length > 0) this.#done.push({ label: command.label, changes: joined, coalesce });
    } else {
      this.#done.push({ label: command.label, changes, coalesce });
      if (this.#done.length > longestHistory) this.#done.shift();
    }
    return true;
  }

  /** Ends a run of coalesced commands. */
  commit(): void {
    const last = this.#done.pop();
    if (last) this.#done.push({ ...last, coalesce: null });
  }

  undo(): boolean {
    const step = this.#done.pop();
    if (step === undefined) return false;
    this.#document = undoChanges(this.#document as Json, step.changes) as T;
    this.#undone.push({ ...step, coalesce: null });
    return true;
  }

  redo(): boolean {
    const step = this.#undone.pop();
    if (step === undefined) return false;
    this.#document = redoChanges(this.#document as Json, step.changes) as T;
    this.#done.push(step);
    return true;
  }
}
