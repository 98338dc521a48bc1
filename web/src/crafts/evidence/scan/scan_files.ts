// SPDX-License-Identifier: GPL-3.0-or-later
// Which file of a scan, or of photographs, goes to which input of the operation that measures it.
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

const isPicture = ({ name }: { readonly name: string }) => /\.(png|jpe?g)$/i.test(name);
const isMesh = ({ name }: { readonly name: string }) => /\.(obj|glb|ply)$/i.test(name);

/** Pictures without a scan are photographs: several of them, or beside others that came before. */
export function arePhotographs(
  dropped: readonly { readonly name: string }[],
  before: { readonly photographs: boolean; readonly scan: boolean },
): boolean {
  if (before.scan || dropped.some(isMesh)) return false;
  return before.photographs || dropped.filter(isPicture).length >= 2;
}

/** "photograph", "photograph_2", ... */
const photographInput = (index: number): string => (index === 0 ? 'photograph' : `photograph_${index + 1}`);

/** Photographs are added to those that are there, under the next numbers; the last pattern.json stays. */
export function photographInputs(files: readonly File[], photographsBefore: number): InputFile[] {
  const photographs = files
    .filter(isPicture)
    .map((file, i) => ({ input: photographInput(photographsBefore + i), file }));
  const pattern = files.filter(({ name }) => /\.json$/i.test(name)).slice(-1);
  return [...photographs, ...pattern.map((file) => ({ input: 'pattern', file }))];
}
