// SPDX-License-Identifier: GPL-3.0-or-later
import { toast } from '../ui';

export const sentenceOf = (thrown: unknown): string =>
  thrown instanceof Error ? thrown.message : String(thrown);

/** What goes wrong in it is told in a toast. */
export function told(work: Promise<unknown>): void {
  work.catch((thrown: unknown) => toast(sentenceOf(thrown), true));
}
