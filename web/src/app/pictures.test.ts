// SPDX-License-Identifier: GPL-3.0-or-later
// @vitest-environment node
import { existsSync, readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { expect, it } from 'vitest';
import type { Catalog } from '../jobs/contract';

const path = (relative: string) => fileURLToPath(new URL(`../../../${relative}`, import.meta.url));

it('has a picture of every sample; npm run pictures draws what is missing', () => {
  const { samples } = JSON.parse(readFileSync(path('tests/job/catalog.json'), 'utf8')) as Catalog;
  const missing = samples.filter(({ name }) => !existsSync(path(`web/public/pictures/${name}.webp`)));
  expect(missing.map(({ name }) => name)).toEqual([]);
});
