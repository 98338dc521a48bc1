// SPDX-License-Identifier: GPL-3.0-or-later
// One file for a whole project: a zip with project.json and blobs/<sha256>.
import type { Unzipped, Zippable } from 'fflate';
import { unzip, zip } from 'fflate';
import { sha256Hex } from '../jobs/hash';
import type { BlobStore } from './blob_store';
import type { ProjectDocument } from './document';
import { asDocument, blobsOf } from './document';
import { storageSentence } from './storage';

export const projectExtension = 'formwright';

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

/** Puts the blobs into the store and returns the document. Throws Error with one sentence. */
export async function unpackProject(
  bytes: Uint8Array<ArrayBuffer>,
  blobs: BlobStore,
): Promise<ProjectDocument> {
  const files = await new Promise<Unzipped>((resolve, reject) =>
    unzip(bytes, (error, data) => (error ? reject(error) : resolve(data))),
  ).catch(() => {
    throw new Error('This project file is damaged: it is not a complete zip archive.');
  });
  const text = files['project.json'];
  if (text === undefined) throw new Error('This is not a Formwright project: it holds no project.json.');
  let value: unknown;
  try {
    value = JSON.parse(new TextDecoder().decode(text));
  } catch {
    throw new Error('This project file is damaged: its document cannot be read.');
  }
  const document = asDocument(value);
  for (const sha256 of blobsOf(document)) {
    const content = files[`blobs/${sha256}`] as Uint8Array<ArrayBuffer> | undefined;
    if (content === undefined) continue; // an output that was never kept; it can be made again
    if ((await sha256Hex(content)) !== sha256)
      throw new Error('This project file is damaged: a model in it does not match its checksum.');
    await blobs.put(content).catch((thrown: unknown) => {
      throw new Error(storageSentence(thrown));
    });
  }
  return document;
}
