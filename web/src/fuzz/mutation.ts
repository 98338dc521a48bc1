// SPDX-License-Identifier: GPL-3.0-or-later
// A small fuzzer for the page's readers: sound files, altered by a seeded generator, so that a failure is found again.

export type Bytes = Uint8Array<ArrayBuffer>;

/** mulberry32: 32 bits of state, the same numbers everywhere. */
function generator(seed: number): (below: number) => number {
  let state = seed >>> 0;
  return (below) => {
    state = (state + 0x6d2b79f5) >>> 0;
    let z = Math.imul(state ^ (state >>> 15), state | 1);
    z ^= z + Math.imul(z ^ (z >>> 7), z | 61);
    return below <= 0 ? 0 : ((z ^ (z >>> 14)) >>> 0) % below;
  };
}

const numbers = ['0', '-1', '1e308', '4294967295', 'NaN', '99999999999', '.', 'G2', 'X', '{', '"'];

/** Up to eight changes: bytes, bits, pieces cut out or doubled, numbers that are too large. */
export function altered(sample: Bytes, seed: number): Bytes {
  const below = generator(seed);
  let bytes = sample.slice();
  for (let change = 1 + below(8); change > 0 && bytes.length > 0; --change) {
    const at = below(bytes.length);
    const size = Math.min(bytes.length - at, 1 + below(24));
    const spliced = (from: number, to: number, piece: Uint8Array) => {
      const next = new Uint8Array(from + piece.length + bytes.length - to);
      next.set(bytes.subarray(0, from));
      next.set(piece, from);
      next.set(bytes.subarray(to), from + piece.length);
      bytes = next;
    };
    switch (below(6)) {
      case 0:
        bytes[at] = below(256);
        break;
      case 1:
        bytes[at] = (bytes[at] ?? 0) ^ (1 << below(8));
        break;
      case 2:
        spliced(at, at + size, new Uint8Array());
        break;
      case 3:
        spliced(at, at, bytes.slice(at, at + size));
        break;
      case 4:
        spliced(at, at + 1, new TextEncoder().encode(numbers[below(numbers.length)] ?? ''));
        break;
      default:
        bytes.fill(0xff, at, at + Math.min(size, 4));
    }
  }
  return bytes;
}
