// SPDX-License-Identifier: GPL-3.0-or-later
// Writes dist/sw.js after a build: scripts/service_worker.js with the list of files to keep and a
// version made from their contents, so that a new build replaces the old files all at once.
import { createHash } from 'node:crypto';
import { existsSync, readdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { join, relative, resolve, sep } from 'node:path';
import type { Plugin, ResolvedConfig } from 'vite';

function filesBelow(folder: string): string[] {
  return readdirSync(folder)
    .map((name) => join(folder, name))
    .flatMap((path) => (statSync(path).isDirectory() ? filesBelow(path) : [path]));
}

export function serviceWorker(): Plugin {
  let config: ResolvedConfig;
  return {
    name: 'formwright-service-worker',
    apply: 'build',
    configResolved: (resolved) => {
      config = resolved;
    },
    closeBundle: () => {
      const dist = resolve(config.root, config.build.outDir);
      if (!existsSync(join(dist, 'index.html'))) return;
      const files = filesBelow(dist)
        .map((path) => relative(dist, path).split(sep).join('/'))
        .filter((path) => path !== 'sw.js' && !path.endsWith('.map'))
        .sort();
      const hash = createHash('sha256');
      for (const file of files) hash.update(file).update(readFileSync(join(dist, file)));
      const source = readFileSync(resolve(config.root, 'scripts/service_worker.js'), 'utf8')
        .replace('__VERSION__', hash.digest('hex').slice(0, 16))
        .replace("['__FILES__']", JSON.stringify(files));
      writeFileSync(join(dist, 'sw.js'), source);
    },
  };
}
