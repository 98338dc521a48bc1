// SPDX-License-Identifier: GPL-3.0-or-later
// @vitest-environment happy-dom
import { signal } from '@preact/signals';
import { h, render } from 'preact';
import { act } from 'preact/test-utils';
import { expect, test } from 'vitest';
import type { Catalog, Operation, ParameterSchema } from '../../jobs/contract';
import { newDocument } from '../../project/document';
import type { Command } from '../../project/history';
import type { ProjectDocument } from '../../project/document';
import type { CraftModel, CraftResult } from '../../shared/session/craft_document';
import type { Services } from '../../shared/session/services';
import { ResultsStrip } from './results_strip';
import { design, planning, zippable } from './zippable_document';
import { ZippableSession } from './zippable_session';

const number = (value: number): ParameterSchema => ({ type: 'number', default: value });
const operation = (name: string, properties: Record<string, ParameterSchema>): Operation => ({
  name,
  title: name,
  inputs: [],
  parameters: { properties },
  outputs: [],
});
const operations = [
  operation(design, { width_mm: number(30) }),
  operation(planning, { bed_x_mm: number(600), rig: { type: 'boolean', default: false } }),
];
const catalog: Catalog = { version: '', operations, samples: [], mesh_formats: [] };

const blob = (digit: string) => ({ blob: digit.repeat(64), bytes: 1, media_type: 'x' });
const source = { kind: 'sample', sample: 'star', title: 'Star' } as const;
const model: CraftModel = { source, mesh: blob('a'), preview: blob('b'), report: {} };
const earlier: CraftResult = {
  id: 'r',
  made_unix_s: 0,
  backend: 'wasm',
  seconds: 1,
  mesh: model.mesh.blob,
  parameters: { width_mm: 40 },
  report: {},
  outputs: {},
};

test('back to an earlier ribbon, bed and rig stay as they are set', async () => {
  const document = signal<ProjectDocument>(newDocument('1', 'One', 0));
  const run = (command: Command<ProjectDocument>) => (document.value = command.apply(document.value));
  const projects = { document, do: run, commit: () => undefined, blobs: {} };
  const session = new ZippableSession({ projects, catalog: signal(catalog) } as unknown as Services);
  const all = session.operation.value as Operation;
  run(zippable.openModel(all, model, 'Open', {}, () => false));
  run(zippable.addResult(earlier));
  run(zippable.setParameters(all, { width_mm: 20, bed_x_mm: 300, rig: true }, 'Set'));

  const root = window.document.body.appendChild(window.document.createElement('div'));
  await act(() => render(h(ResultsStrip, { session }), root));
  await act(() => root.querySelector<HTMLButtonElement>('.result')?.click());
  expect(session.document.value.parameters).toEqual({ width_mm: 40, bed_x_mm: 300, rig: true });
  expect(session.result.value?.id).toBe('r');
});
