// SPDX-License-Identifier: GPL-3.0-or-later
// A reader for the polylines of an OBJ file as the core writes them: vertices, and lines that name them.

/** x, y, z per point, a line each. Throws Error with one sentence where a line names a vertex that is not there. */
export function parsePolylines(bytes: Uint8Array): Float32Array<ArrayBuffer>[] {
  const positions: number[] = [];
  const lines: Float32Array<ArrayBuffer>[] = [];
  for (const text of new TextDecoder().decode(bytes).split('\n')) {
    const [kind, ...words] = text.trim().split(/\s+/);
    if (kind === 'v') positions.push(...[0, 1, 2].map((k) => Number(words[k] ?? 0)));
    if (kind !== 'l') continue;
    const line = new Float32Array(3 * words.length);
    words.forEach((word, i) => {
      const at = 3 * (Number(word) - 1);
      if (!(at >= 0 && at < positions.length))
        throw new Error(`The curve names vertex ${word}, which it does not have.`);
      for (let k = 0; k < 3; ++k) line[3 * i + k] = positions[at + k] ?? 0;
    });
    lines.push(line);
  }
  return lines;
}
