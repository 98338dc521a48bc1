// SPDX-License-Identifier: GPL-3.0-or-later
// `virtual:licences`: name, version, licence and notice of every package that ends up in the bundle.
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import type { Plugin } from 'vite';

export interface Licence {
  name: string;
  version: string;
  licence: string;
  notice: string;
}

const isNotice = (file: string) => /^(licen[cs]e|copying|notice)/i.test(file);

/** The production dependencies in node_modules, with theirs, sorted by name. */
export function bundledLicences(root: string): Licence[] {
  const seen = new Map<string, Licence>();
  const visit = (name: string) => {
    const folder = join(root, 'node_modules', name);
    if (seen.has(name) || !existsSync(join(folder, 'package.json'))) return;
    const manifest = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8')) as {
      version: string;
      license?: string;
      dependencies?: Record<string, string>;
    };
    const notice = readdirSync(folder).find(isNotice);
    seen.set(name, {
      name,
      version: manifest.version,
      licence: manifest.license ?? 'see notice',
      notice: notice === undefined ? '' : readFileSync(join(folder, notice), 'utf8').trim(),
    });
    for (const dependency of Object.keys(manifest.dependencies ?? {})) visit(dependency);
  };
  const own = JSON.parse(readFileSync(join(root, 'package.json'), 'utf8')) as {
    dependencies?: Record<string, string>;
  };
  for (const dependency of Object.keys(own.dependencies ?? {})) visit(dependency);
  return [...seen.values()].sort((a, b) => a.name.localeCompare(b.name));
}

export function licences(): Plugin {
  const id = 'virtual:licences';
  return {
    name: 'formwright-licences',
    resolveId: (source) => (source === id ? `\0${id}` : undefined),
    load: (source) =>
      source === `\0${id}`
        ? `export default ${JSON.stringify(bundledLicences(resolve(import.meta.dirname, '..')))};`
        : undefined,
  };
}
