// SPDX-License-Identifier: GPL-3.0-or-later
// @vitest-environment node
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { expect, it } from 'vitest';
import { solverParts } from './solver_parts';

const root = fileURLToPath(new URL('../../../', import.meta.url));
/** The operating system's and the compiler's own. */
const system =
  /^(sys|arpa|netinet|linux|emscripten|unistd|fcntl|dirent|sched|signal|pthread|poll|spawn|asm|netdb|strings|termios|\w*intrin|wasm_simd128)$/;

it('names every library that the C++ side includes, and no other', () => {
  const found = new Set<string>();
  for (const folder of ['core', 'native_worker', 'wasm'])
    for (const file of readdirSync(join(root, folder), { recursive: true, encoding: 'utf8' })) {
      if (!/\.(h|cpp)$/.test(file)) continue;
      const text = readFileSync(join(root, folder, file), 'utf8');
      // Standard headers have neither folder nor ending.
      for (const [, word = ''] of text.matchAll(/#include <([A-Za-z_0-9]+)[/.]/g))
        if (!system.test(word)) found.add(word);
    }
  expect([...found].sort()).toEqual(solverParts.map(({ include }) => include).sort());
});
