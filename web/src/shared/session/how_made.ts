// SPDX-License-Identifier: GPL-3.0-or-later
// How results were made, as a file: enough to make them again, and to tell which file belongs to which numbers.
import type { CraftResult } from './craft_document';
import { download, safeFileName } from './download';

/** From the first step on; results of earlier versions say nothing of themselves and are left out. */
export function howMade(results: readonly (CraftResult | null | undefined)[]): string {
  const steps = results.flatMap((result) => {
    const record = result?.report['made_by'];
    if (!result || record === undefined) return [];
    return [
      {
        made_by: record,
        made: new Date(1000 * result.made_unix_s).toISOString(),
        seconds: result.seconds,
        files: Object.fromEntries(
          Object.entries(result.outputs).map(([name, { blob, bytes }]) => [name, { sha256: blob, bytes }]),
        ),
        report: result.report,
      },
    ];
  });
  return `${JSON.stringify({ format: 'formwright-how-made', version: 1, steps }, null, 2)}\n`;
}

/** For the menu of an export button. */
export const howMadeItem = (title: string, ...results: readonly (CraftResult | null | undefined)[]) => ({
  label: 'How it was made (JSON)',
  disabledReason: results.some((result) => result?.report['made_by'])
    ? undefined
    : 'This was made by an earlier version, which did not write it down',
  onSelect: () =>
    download(
      new TextEncoder().encode(howMade(results)),
      `${safeFileName(title)}-how-it-was-made.json`,
      'application/json',
    ),
});
