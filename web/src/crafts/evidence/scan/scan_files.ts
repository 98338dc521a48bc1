// SPDX-License-Identifier: GPL-3.0-or-later
// Which file of a scan goes to which input of the operation that measures it.
import type { InputDeclaration, Operation } from '../../../jobs/contract';

export interface InputFile {
  readonly input: string;
  readonly file: File;
}

/** Every file goes to the first input that takes its ending; the last of several stays. */
export function scanInputs(files: readonly File[], operation: Operation | undefined): InputFile[] {
  const found = new Map<string, File>();
  for (const file of files) {
    const takes = ({ extensions = [] }: InputDeclaration) =>
      extensions.some((ending) => file.name.toLowerCase().endsWith(`.${ending}`));
    const input = operation?.inputs.find(takes);
    if (input) found.set(input.name, file);
  }
  return [...found].map(([input, file]) => ({ input, file }));
}
