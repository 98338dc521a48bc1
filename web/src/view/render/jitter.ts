// SPDX-License-Identifier: GPL-3.0-or-later
// Where the samples of a refined picture lie.

/** Radical inverse: an evenly filling sequence in 0..1. */
function halton(index: number, base: number): number {
  let result = 0;
  let f = 1;
  for (let i = index; i > 0; i = Math.floor(i / base)) {
    f /= base;
    result += f * (i % base);
  }
  return result;
}

/** Place within the pixel (-0.5..0.5, a little wider for a soft edge) and on the light's disc (-1..1). */
export function jitter(sample: number): [number, number, number, number] {
  const r = Math.sqrt(halton(sample + 1, 5));
  const a = 2 * Math.PI * halton(sample + 1, 7);
  return [
    1.1 * (halton(sample + 1, 2) - 0.5),
    1.1 * (halton(sample + 1, 3) - 0.5),
    r * Math.cos(a),
    r * Math.sin(a),
  ];
}
