// SPDX-License-Identifier: GPL-3.0-or-later
// The models as their viewpoints see them, from models.zip, as addresses that a page can show.
import { ZipReader } from '../../../../project/zip_reader';

export interface ModelPicture {
  readonly url: string;
  /** Of its width. */
  readonly height_share: number;
}

const sameBytes = (a: Uint8Array, b: Uint8Array): boolean =>
  a.length === b.length && a.every((byte, i) => byte === b[i]);

/** Width and height stand at the head of every PNG (W3C PNG, 11.2.1). */
function heightShare(png: Uint8Array<ArrayBuffer>): number {
  const view = new DataView(png.buffer, png.byteOffset, png.byteLength);
  return view.getUint32(20) / view.getUint32(16);
}

/** Keeps the addresses while the pictures stay the same, so that they do not flicker while pillars are dragged. */
export class ModelPictures {
  #bytes = new Uint8Array();
  #pictures: readonly ModelPicture[] = [];

  of(bytes: Uint8Array<ArrayBuffer>): readonly ModelPicture[] {
    if (sameBytes(bytes, this.#bytes)) return this.#pictures;
    for (const { url } of this.#pictures) URL.revokeObjectURL(url);
    const zip = new ZipReader(bytes, 'The file of the models');
    this.#pictures = [...zip.entries.values()].map((entry) => {
      const png = zip.readNow(entry);
      return {
        url: URL.createObjectURL(new Blob([png], { type: 'image/png' })),
        height_share: heightShare(png),
      };
    });
    this.#bytes = bytes;
    return this.#pictures;
  }
}
