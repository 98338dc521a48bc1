// SPDX-License-Identifier: GPL-3.0-or-later
// What was dropped, with the files of dropped folders; those know their folder, as if it had been chosen.

const fileOf = (entry: FileSystemFileEntry): Promise<File> =>
  new Promise((resolve, reject) => entry.file(resolve, reject));

async function filesIn(folder: FileSystemDirectoryEntry): Promise<File[]> {
  const reader = folder.createReader();
  const files: File[] = [];
  for (;;) {
    // A reader gives its entries in portions until there are none left.
    const entries = await new Promise<FileSystemEntry[]>((resolve, reject) =>
      reader.readEntries(resolve, reject),
    );
    if (entries.length === 0) return files;
    for (const entry of entries) {
      if (entry.isDirectory) {
        files.push(...(await filesIn(entry as FileSystemDirectoryEntry)));
        continue;
      }
      const file = await fileOf(entry as FileSystemFileEntry);
      Object.defineProperty(file, 'webkitRelativePath', { value: entry.fullPath.replace(/^\//, '') });
      files.push(file);
    }
  }
}

/** To be called within the drop's event: its items are gone afterwards. */
export async function droppedFiles({ items, files }: DataTransfer): Promise<File[]> {
  const plain = [...files];
  const folders = [...items]
    .map((item) => item.webkitGetAsEntry())
    .filter((entry): entry is FileSystemDirectoryEntry => entry?.isDirectory === true);
  if (folders.length === 0) return plain;
  const names = new Set(folders.map(({ name }) => name));
  const inFolders = await Promise.all(folders.map(filesIn));
  return [...plain.filter(({ name }) => !names.has(name)), ...inFolders.flat()];
}
