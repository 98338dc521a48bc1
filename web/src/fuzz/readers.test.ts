// SPDX-License-Identifier: GPL-3.0-or-later
// Everything the page reads itself: each altered file is read, or refused with a sentence. `npm test` runs some hundred
// of each; `npm run fuzz` as many as fit into VITE_FUZZ_SECONDS for each reader.
import { zipSync } from 'fflate';
import { describe, expect, it } from 'vitest';
import { parsePly } from '../jobs/ply';
import { parsePolylines } from '../jobs/polylines';
import { readGcodePath } from '../machines/gcode_path';
import { printFacts } from '../machines/printing/gcode_facts';
import { readToolPath } from '../machines/toolpath';
import { packProject, unpackProject } from '../project/archive';
import { BlobStore } from '../project/blob_store';
import { asDocument, newDocument } from '../project/document';
import { parseJson } from '../project/json_text';
import { MemoryStorage } from '../project/storage';
import { ZipReader } from '../project/zip_reader';
import type { Bytes } from './mutation';
import { altered } from './mutation';

const seconds = Number(import.meta.env['VITE_FUZZ_SECONDS'] ?? 0);
const short = 400;
/** No altered file of some kilobytes may take longer, on a busy machine either. */
const longest_ms = 10_000;

const bytesOf = (text: string): Bytes => new TextEncoder().encode(text);
const textOf = (bytes: Bytes) => new TextDecoder().decode(bytes);

const gcode = `; laser\nG21 G90\nM4 S0\nG0 X1 Y2\nG1 X50 Y2 F1200 S400\nG2 X60 Y12 I0 J10\nG3 X50 Y2 R10\nG91\nG1 X-5 Y.5\nM5\nG4 P0.5\nM2\n`;
const toolPath = JSON.stringify({
  format: 'formwright tool path',
  version: 1,
  bed_mm: [300, 200],
  paths: [{ points_mm: [0, 0, 1, 1], times_s: [0, 1], lines: [1, 2] }],
});
const ply = bytesOf(
  `ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n${'\0'.repeat(36)}\x03${'\0'.repeat(12)}`,
);
async function project(): Promise<Bytes> {
  const blobs = new BlobStore(new MemoryStorage());
  const blob = await blobs.put(bytesOf('v 0 0 0\n'.repeat(200)));
  const document = newDocument('one', 'One', 1);
  const crafts = { relief: { mesh: { blob, bytes: 1600, media_type: 'model/obj' } } };
  return await packProject({ ...document, crafts }, blobs);
}

/** A reader throws what it throws on purpose: a plain Error with a sentence. */
const isSentence = (thrown: unknown): boolean =>
  thrown instanceof Error &&
  thrown.constructor === Error &&
  /^[“A-Z].*[.]$/su.test(thrown.message) &&
  thrown.message.length < 1000;
/** JSON.parse has no other way to say no. */
const isSyntax = (thrown: unknown): boolean => thrown instanceof SyntaxError;

interface Target {
  readonly name: string;
  readonly samples: () => Promise<Bytes[]> | Bytes[];
  readonly read: (bytes: Bytes) => unknown;
  readonly refuses?: (thrown: unknown) => boolean;
}

const targets: readonly Target[] = [
  {
    name: 'project file',
    samples: async () => [await project()],
    read: (bytes) => unpackProject(bytes, new BlobStore(new MemoryStorage())),
  },
  {
    name: 'zip archive',
    samples: () => [zipSync({ a: bytesOf('words '.repeat(300)), 'b/c': bytesOf('c') }) as Bytes],
    read: async (bytes) => {
      const reader = new ZipReader(bytes, 'The file');
      for (const entry of reader.entries.values()) await reader.read(entry);
    },
  },
  {
    name: 'JSON of a document',
    samples: () => [bytesOf(JSON.stringify(newDocument('one', 'One', 1)))],
    read: (bytes) => asDocument(parseJson(textOf(bytes))),
    refuses: (thrown) => isSentence(thrown) || isSyntax(thrown),
  },
  {
    name: 'G-code',
    samples: () => [bytesOf(gcode)],
    read: (bytes) => readGcodePath(textOf(bytes), [300, 200], 1000),
  },
  { name: 'G-code of a print', samples: () => [bytesOf(gcode)], read: printFacts },
  {
    name: 'tool path',
    samples: () => [bytesOf(toolPath)],
    read: (bytes) => readToolPath(textOf(bytes)),
    refuses: (thrown) => isSentence(thrown) || isSyntax(thrown),
  },
  { name: 'PLY', samples: () => [ply], read: parsePly },
  {
    name: 'polylines',
    samples: () => [bytesOf('v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2 3\nl 3 1\n')],
    read: parsePolylines,
  },
];

describe.each(targets)('$name from elsewhere', ({ samples, read, refuses = isSentence }) => {
  it('is read or refused, whatever was altered', { timeout: 120_000 + 2000 * seconds }, async () => {
    const all = await samples();
    for (const sample of all) await read(sample);
    const end = performance.now() + 1000 * seconds;
    for (let seed = 1; seed <= short || performance.now() < end; ++seed) {
      const bytes = altered(all[seed % all.length] as Bytes, seed);
      const start = performance.now();
      try {
        await read(bytes);
      } catch (thrown) {
        expect(refuses(thrown), `seed ${seed}: ${String(thrown)}`).toBe(true);
      }
      expect(performance.now() - start, `seed ${seed}`).toBeLessThan(longest_ms);
    }
  });
});
