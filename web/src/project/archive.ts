// SPDX-License-Identifier: GPL-3.0-or-later
// One file for a whole project: a zip with project.json and blobs/<sha256>.
import type { Zippable } from 'fflate';
import { zip } from 'fflate';
import { sha256Hex } from '../jobs/hash';
import type { BlobStore } from './blob_store';
import type { ProjectDocument } from './document';
import { asDocument, blobsOf } from './document';
import { parseJson } from './json_text';
import { storageSentence } from './storage';
import { ZipReader } from './zip_reader';

export const projectExtension = 'formwright';

/** A document names its files and holds numbers and words: a hundred crafts take a megabyte. */
const maxDocumentBytes = 16 * 2 ** 20;

export async function packProject(
  document: ProjectDocument,
  blobs: BlobStore,
): Promise<Uint8Array<ArrayBuffer>> {
  const files: Zippable = { 'project.json': new TextEncoder().encode(JSON.stringify(document, null, 1)) };
  for (const sha256 of blobsOf(document))
    if (await blobs.has(sha256)) files[`blobs/${sha256}`] = await blobs.read(sha256);
  return await new Promise((resolve, reject) =>
    zip(files, { level: 6, consume: false }, (error, data) =>
      error ? reject(error) : resolve(data as Uint8Array<ArrayBuffer>),
    ),
  );
}

/** Puts the blobs into the store, one after the other, and returns the document. Only what the document names is
 *  unpacked. Throws Error with one sentence. */
export async function unpackProject(
  bytes: Uint8Array<ArrayBuffer>,
  blobs: BlobStore,
): Promise<ProjectDocument> {
  const archive = new ZipReader(bytes, 'This project file');
  const text = archive.entries.get('project.json');
  if (text === undefined) throw new Error('This is not a Formwright project: it holds no project.json.');
  if (text.bytes > maxDocumentBytes)
    throw new Error('This project file is damaged: its document is larger than any project’s.');
  const written = await archive.read(text);
  let value: unknown;
  try {
    value = parseJson(new TextDecoder().decode(written));
  } catch {
    throw new Error('This project file is damaged: its document cannot be read.');
  }
  const document = asDocument(value);
  for (const sha256 of blobsOf(document)) {
    const entry = archive.entries.get(`blobs/${sha256}`);
    if (entry === undefined) continue; // an output that was never kept; it can be made again
    const content = await archive.read(entry);
    if ((await sha256Hex(content)) !== sha256)
      throw new Error('This project file is damaged: a model in it does not match its checksum.');
    await blobs.put(content).catch((thrown: unknown) => {
      throw new Error(storageSentence(thrown));
    });
  }
  return document;
}
