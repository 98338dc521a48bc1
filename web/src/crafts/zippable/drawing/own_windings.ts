// SPDX-License-Identifier: GPL-3.0-or-later
// Windings part by part, as the operation writes them: "3 0 2.5", 0 where a part is as all are.
import type { Json } from '../../../jobs/contract';

export const ownWindings = (text: Json): number[] =>
  typeof text === 'string' ? (text.match(/[^\s,;]+/g) ?? []).map(Number) : [];

export function withOwnWindings(given: readonly number[], part: number, windings: Json): string {
  const all = Array.from({ length: Math.max(given.length, part + 1) }, (_, i) => given[i] ?? 0);
  all[part] = typeof windings === 'number' ? windings : 0;
  while (all.at(-1) === 0) all.pop();
  return all.join(' ');
}
