// SPDX-License-Identifier: GPL-3.0-or-later
// Notes and warnings of a report, each with what helps where the report knows that.
import type { JsonObject, Report } from '../../jobs/contract';
import { isObject } from '../../project/document';
import { sentences } from './report';

interface NoteFix {
  /** An order of a few words, for a button. */
  readonly label: string;
  /** New values by name. */
  readonly parameters: JsonObject;
}

export interface ReportNote {
  readonly sentence: string;
  readonly fix: NoteFix | null;
}

/** Those of the named lists of a report, in their order, each sentence once. */
export function notesOf(report: Report, ...names: readonly string[]): ReportNote[] {
  const fixes = new Map<string, NoteFix>();
  const listed = report['fixes'];
  for (const one of Array.isArray(listed) ? listed : []) {
    if (!isObject(one)) continue;
    const { sentence, label, parameters } = one;
    if (typeof sentence === 'string' && typeof label === 'string' && isObject(parameters))
      fixes.set(sentence, { label, parameters });
  }
  const all = new Set(names.flatMap((name) => sentences(report, name)));
  return [...all].map((sentence) => ({ sentence, fix: fixes.get(sentence) ?? null }));
}

/** A sentence as what is the matter, and what follows from it: at its colon, or its first full stop. */
export function headed(sentence: string): readonly [head: string, rest: string] {
  const [, head = sentence, tail = ''] = /^(.*?[^\d])[:.]\s+(.+)$/.exec(sentence) ?? [];
  return [head.replace(/\.$/, ''), tail && tail.charAt(0).toUpperCase() + tail.slice(1)];
}
