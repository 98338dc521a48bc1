// SPDX-License-Identifier: GPL-3.0-or-later
// How results were made, as a file: enough to make them again, and to tell which file belongs to which numbers.
import type { BlobReference } from '../../project/document';
import type { CraftModel, CraftResult } from './craft_document';
import { download, safeFileName } from './download';

const filesOf = (outputs: Readonly<Record<string, BlobReference>>) =>
  Object.fromEntries(
    Object.entries(outputs).map(([name, { blob, bytes }]) => [name, { sha256: blob, bytes }]),
  );

type Results = readonly (CraftResult | null | undefined)[];

/** From the reading of the model on; what earlier versions made says nothing of itself and is left out. */
export function howMade(model: CraftModel | null, results: Results): string {
  const read = model?.report['made_by'];
  const steps = [
    ...(model && read !== undefined ? [{ made_by: read, files: filesOf({ 'model.ply': model.mesh }) }] : []),
    ...results.flatMap((result) => {
      const record = result?.report['made_by'];
      if (!result || record === undefined) return [];
      const { made_unix_s, seconds, outputs, report } = result;
      const made = new Date(1000 * made_unix_s).toISOString();
      return [{ made_by: record, made, seconds, files: filesOf(outputs), report }];
    }),
  ];
  return `${JSON.stringify({ format: 'formwright-how-made', version: 1, steps }, null, 2)}\n`;
}

/** For the menu of an export button. */
export const howMadeItem = (title: string, model: CraftModel | null, ...results: Results) => ({
  label: 'How it was made (JSON)',
  disabledReason: results.some((result) => result?.report['made_by'])
    ? undefined
    : 'This was made by an earlier version, which did not write it down',
  onSelect: () =>
    download(
      new TextEncoder().encode(howMade(model, results)),
      `${safeFileName(title)}-how-it-was-made.json`,
      'application/json',
    ),
});
