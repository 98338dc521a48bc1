// SPDX-License-Identifier: GPL-3.0-or-later
// Zip archives that come from elsewhere (PKWARE APPNOTE 6.3): what is unpacked is counted while it is unpacked, and
// stays within what a file of that size really holds.
import { Inflate } from 'fflate';

export interface ZipEntry {
  readonly name: string;
  readonly offset: number;
  readonly packed_bytes: number;
  readonly bytes: number;
  readonly crc: number;
  readonly method: number;
  readonly encrypted: boolean;
}

const baseBytes = 64 * 2 ** 20;
/** Meshes and their numbers pack 2 to 20 times, a bomb a thousand times. */
const bytesPerPackedByte = 200;
/** Of one archive, whatever its size: more fits into no tab. */
const maxUnpackedBytes = 2 * 2 ** 30 - 1;
/** So that one step of unpacking makes at most 16 MB. */
const slice_bytes = 16 * 1024;
/** Deflate packs a run of 258 bytes into 2 bits (RFC 1951, 3.2.5). */
const deflateRatio = 1032;
const turn_ms = 30;

const crcTable = Uint32Array.from({ length: 256 }, (_, byte) => {
  let value = byte;
  for (let bit = 0; bit < 8; ++bit) value = value & 1 ? 0xedb88320 ^ (value >>> 1) : value >>> 1;
  return value;
});
function crc32(bytes: Uint8Array): number {
  let crc = -1;
  for (const byte of bytes) crc = (crcTable[(crc ^ byte) & 255] as number) ^ (crc >>> 8);
  return ~crc >>> 0;
}

export class ZipReader {
  readonly entries: ReadonlyMap<string, ZipEntry>;
  readonly #bytes: Uint8Array<ArrayBuffer>;
  readonly #view: DataView;
  readonly #what: string;
  #left_bytes: number;

  /** `what` begins the sentences: "This project file". Throws Error with one sentence. */
  constructor(bytes: Uint8Array<ArrayBuffer>, what: string) {
    this.#bytes = bytes;
    this.#view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    this.#what = what;
    this.#left_bytes = Math.min(baseBytes + bytesPerPackedByte * bytes.length, maxUnpackedBytes);
    this.entries = this.#readDirectory();
  }

  /** The content of an entry. Throws Error with one sentence. */
  readNow(entry: ZipEntry): Uint8Array<ArrayBuffer> {
    const steps = this.#unpack(entry);
    for (;;) {
      const step = steps.next();
      if (step.done) return step.value;
    }
  }

  /** The same, with the page going on meanwhile. */
  async read(entry: ZipEntry): Promise<Uint8Array<ArrayBuffer>> {
    const steps = this.#unpack(entry);
    let turn = performance.now();
    for (;;) {
      const step = steps.next();
      if (step.done) return step.value;
      if (performance.now() - turn < turn_ms) continue;
      await new Promise((resolve) => setTimeout(resolve));
      turn = performance.now();
    }
  }

  #damaged(): never {
    throw new Error(`${this.#what} is damaged: it is not a complete zip archive. Export or copy it again.`);
  }

  #readDirectory(): Map<string, ZipEntry> {
    const view = this.#view;
    // The end record is the last, but for a comment of at most 65535 bytes.
    let end = view.byteLength - 22;
    const lowest = Math.max(0, end - 65535);
    while (end >= lowest && view.getUint32(end, true) !== 0x06054b50) --end;
    if (end < lowest) this.#damaged();
    const count = view.getUint16(end + 10, true);
    const start = view.getUint32(end + 16, true);
    if (count === 0xffff || start === 0xffffffff)
      throw new Error(`${this.#what} is an archive of more than 4 GB, which cannot be opened here.`);
    const entries = new Map<string, ZipEntry>();
    let at = start;
    for (let i = 0; i < count; ++i) {
      if (at + 46 > end || view.getUint32(at, true) !== 0x02014b50) this.#damaged();
      const nameBytes = view.getUint16(at + 28, true);
      const next = at + 46 + nameBytes + view.getUint16(at + 30, true) + view.getUint16(at + 32, true);
      if (next > end) this.#damaged();
      const name = new TextDecoder().decode(this.#bytes.subarray(at + 46, at + 46 + nameBytes));
      const entry: ZipEntry = {
        name,
        offset: view.getUint32(at + 42, true),
        packed_bytes: view.getUint32(at + 20, true),
        bytes: view.getUint32(at + 24, true),
        crc: view.getUint32(at + 16, true),
        method: view.getUint16(at + 10, true),
        encrypted: (view.getUint16(at + 8, true) & 1) !== 0,
      };
      if (entries.has(name)) this.#damaged();
      entries.set(name, entry);
      at = next;
    }
    // Entries that share their bytes multiply a small file: no archiver writes them.
    let free = 0;
    for (const entry of [...entries.values()].sort((a, b) => a.offset - b.offset)) {
      if (entry.offset < free || entry.offset + 30 > start) this.#damaged();
      free = this.#contentOf(entry) + entry.packed_bytes;
      if (free > start) this.#damaged();
    }
    return entries;
  }

  /** Where the content begins, behind the local header. */
  #contentOf({ offset }: ZipEntry): number {
    const view = this.#view;
    if (view.getUint32(offset, true) !== 0x04034b50) this.#damaged();
    return offset + 30 + view.getUint16(offset + 26, true) + view.getUint16(offset + 28, true);
  }

  *#unpack(entry: ZipEntry): Generator<undefined, Uint8Array<ArrayBuffer>> {
    if (entry.encrypted || (entry.method !== 0 && entry.method !== 8))
      throw new Error(`${this.#what} is encrypted or packed in an unusual way; pack it as an ordinary zip.`);
    const from = this.#contentOf(entry);
    const packed = this.#bytes.subarray(from, from + entry.packed_bytes);
    if (entry.method === 0 ? entry.bytes !== packed.length : entry.bytes / deflateRatio > packed.length)
      this.#damaged();
    if (entry.bytes > this.#left_bytes)
      throw new Error(
        `${this.#what} unpacks to far more than a file of its size holds, so it is not opened.`,
      );
    this.#left_bytes -= entry.bytes;
    const content = new Uint8Array(entry.bytes);
    let filled = 0;
    if (entry.method === 0) content.set(packed);
    else {
      const inflate = new Inflate((piece) => {
        if (piece.length > content.length - filled) this.#damaged(); // more than declared
        content.set(piece, filled);
        filled += piece.length;
      });
      for (let at = 0; at < packed.length; at += slice_bytes) {
        try {
          inflate.push(packed.subarray(at, at + slice_bytes), at + slice_bytes >= packed.length);
        } catch {
          this.#damaged();
        }
        yield;
      }
      if (filled !== content.length) this.#damaged();
    }
    if (crc32(content) !== entry.crc) this.#damaged();
    return content;
  }
}
