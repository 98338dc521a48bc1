// SPDX-License-Identifier: GPL-3.0-or-later
// JSON of foreign origin: what walks through a document calls itself once a level, and the stack is not endless.

const maxDepth = 64;

/** The value. Throws where the text is not JSON, or is nested more than 64 deep. */
export function parseJson(text: string): unknown {
  let depth = 0;
  let inString = false;
  for (let i = 0; i < text.length; ++i) {
    const c = text[i];
    if (inString) {
      if (c === '\\') ++i;
      else inString = c !== '"';
    } else if (c === '"') inString = true;
    else if (c === '[' || c === '{') {
      if (++depth > maxDepth) throw new SyntaxError('nested too deep');
    } else if (c === ']' || c === '}') --depth;
  }
  return JSON.parse(text);
}
