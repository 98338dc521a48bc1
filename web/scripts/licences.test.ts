// SPDX-License-Identifier: GPL-3.0-or-later
import { resolve } from 'node:path';
import { expect, it } from 'vitest';
import manifest from '../package.json' with { type: 'json' };
import { bundledLicences } from './licences.ts';

it('finds licence and notice of every package that the page brings along', () => {
  const found = bundledLicences(resolve(import.meta.dirname, '..'));
  const names = found.map(({ name }) => name);
  for (const dependency of Object.keys(manifest.dependencies)) expect(names).toContain(dependency);
  expect(names).toContain('robust-predicates'); // delaunator's
  for (const { name, licence, notice } of found) {
    expect(licence, name).toMatch(/MIT|ISC|BSD|Unlicense/);
    expect(notice, name).not.toBe('');
  }
});
