// SPDX-License-Identifier: GPL-3.0-or-later
import { toast } from '../ui';

export const sentenceOf = (thrown: unknown): string =>
  thrown instanceof Error ? thrown.message : String(thrown);

/** Shows the failure of `work` in a toast. */
export function toastFailure(work: Promise<unknown>): void {
  work.catch((thrown: unknown) => toast(sentenceOf(thrown), true));
}
