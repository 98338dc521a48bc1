// SPDX-License-Identifier: GPL-3.0-or-later
// `virtual:licences`: name, version, licence and notice of every package that ends up in the bundle.
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join, resolve } from 'node:path';
import type { Plugin } from 'vite';

export interface Licence {
  name: string;
  version: string;
  licence: string;
  notice: string;
}

const isNotice = (file: string) => /^(licen[cs]e|copying|notice)/i.test(file);

/** Where Node.js finds the package from the folder of the one that names it; a workspace keeps packages above itself. */
function folderOf(name: string, from: string): string {
  const places = createRequire(join(from, 'package.json')).resolve.paths(name) ?? [];
  const found = places
    .map((place) => join(place, name))
    .find((folder) => existsSync(join(folder, 'package.json')));
  if (found === undefined) throw new Error(`The package ${name} is not installed: run npm ci.`);
  return found;
}

interface Manifest {
  version: string;
  license?: string;
  dependencies?: Record<string, string>;
}
const manifestOf = (folder: string) =>
  JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8')) as Manifest;

/** The production dependencies of the package in `root`, with theirs, sorted by name. */
export function bundledLicences(root: string): Licence[] {
  const seen = new Map<string, Licence>();
  const visit = (name: string, from: string) => {
    if (seen.has(name)) return;
    const folder = folderOf(name, from);
    const manifest = manifestOf(folder);
    const notice = readdirSync(folder).find(isNotice);
    seen.set(name, {
      name,
      version: manifest.version,
      licence: manifest.license ?? 'see notice',
      notice: notice === undefined ? '' : readFileSync(join(folder, notice), 'utf8').trim(),
    });
    for (const dependency of Object.keys(manifest.dependencies ?? {})) visit(dependency, folder);
  };
  for (const dependency of Object.keys(manifestOf(root).dependencies ?? {})) visit(dependency, root);
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
