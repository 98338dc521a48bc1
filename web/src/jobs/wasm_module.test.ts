// SPDX-License-Identifier: GPL-3.0-or-later
// The built WASM module behind the page's own runner and PLY reader; skipped where it is not built.
// @vitest-environment node
import { existsSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { describe, expect, it } from 'vitest';
import type { Job } from './contract';
import { findOperation } from './contract';
import { sha256Hex } from './hash';
import { parsePly } from './ply';
import type { FromWorker, ModuleFactory } from './wasm_messages';
import { WasmRunner } from './wasm_runner';

const module = fileURLToPath(new URL('../../public/wasm/formwright.mjs', import.meta.url));

describe.skipIf(!existsSync(module))('the WASM module', () => {
  const said: FromWorker[] = [];
  const runner = new WasmRunner(
    (message) => said.push(message),
    async (url) => ((await import(/* @vite-ignore */ url)) as { default: ModuleFactory }).default,
  );
  const run = async (job: Job) => {
    await runner.handle({ type: 'run', id: said.length, job });
    const last = said.at(-1);
    if (last?.type !== 'done') throw new Error(JSON.stringify(last));
    return last;
  };

  it(
    'imports a sample, simplifies it, and makes a relief of the asked thickness',
    { timeout: 120_000 },
    async () => {
      await runner.handle({ type: 'load', url: module, cancelFlag: null });
      const ready = said[0];
      if (ready?.type !== 'ready') throw new Error(JSON.stringify(ready));
      const [sample] = ready.catalog.samples;
      expect(ready.catalog.operations.map(({ name }) => name)).toEqual(
        expect.arrayContaining(['relief', 'import', 'simplify']),
      );
      if (sample === undefined) throw new Error('There are no samples.');

      const mesh = { sample: sample.name, vertices: 3000 };
      const imported = await run({
        operation: 'import',
        parameters: {},
        inputs: { mesh },
        outputs: ['model.ply'],
      });
      const model = imported.outputs['model.ply']?.data ?? expect.fail('no model.ply');
      expect(parsePly(model).indices.length).toBe(3 * Number(imported.report['faces']));

      const sha256 = await sha256Hex(model);
      await runner.handle({ type: 'blob', sha256, bytes: model });
      const input = { mesh: { sha256, file_name: 'model.ply' } };
      const simplify = findOperation(ready.catalog, 'simplify');
      const [name = ''] = Object.keys(simplify?.parameters.properties ?? {}).filter((key) =>
        key.includes('vertices'),
      );
      const small = await run({ operation: 'simplify', parameters: { [name]: 1000 }, inputs: input });
      expect(Number(small.report['vertices'])).toBeLessThanOrEqual(1100);

      const thickness_mm = 4;
      const made = await run({
        operation: 'relief',
        parameters: { thickness_mm },
        inputs: input,
        outputs: ['relief.ply'],
      });
      expect(Object.keys(made.outputs)).toEqual(['relief.ply']);
      const relief = parsePly(made.outputs['relief.ply']?.data ?? expect.fail('no relief.ply'));
      const forward = made.report['direction'] as number[];
      const depths = Array.from({ length: relief.positions.length / 3 }, (_, i) =>
        forward.reduce((sum, x, k) => sum + x * (relief.positions[3 * i + k] ?? 0), 0),
      );
      expect(Math.max(...depths) - Math.min(...depths)).toBeCloseTo(thickness_mm, 3);
      for (const column of ['lambda', 'visible', 'normal_error_deg'])
        expect(relief.attributes[column]?.length).toBe(depths.length);
    },
  );

  it('names the parameter that is wrong', async () => {
    const mesh = { sample: 'bust', vertices: 500 };
    await runner.handle({
      type: 'run',
      id: 99,
      job: { operation: 'relief', parameters: { thickness_mm: -1 }, inputs: { mesh } },
    });
    expect(said.at(-1)).toMatchObject({
      type: 'failed',
      error: { code: 'invalid_input', where: 'thickness_mm' },
    });
  });
});
