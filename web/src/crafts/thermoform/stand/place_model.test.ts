// SPDX-License-Identifier: GPL-3.0-or-later
// Placing a model in the page and in the core: the built WASM module answers for the core.
// @vitest-environment node
import { existsSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { beforeAll, describe, expect, it } from 'vitest';
import type { JsonObject } from '../../../jobs/contract';
import { sha256Hex } from '../../../jobs/hash';
import { parsePly } from '../../../jobs/ply';
import type { FromWorker, ModuleFactory } from '../../../jobs/wasm_messages';
import { WasmRunner } from '../../../jobs/wasm_runner';
import { findFlatSides } from '../../../view/mesh/flat_sides';
import { boxOf, placed } from '../placement';
import { placeModel, pointAt, rotationIn, stoodOtherwise } from './place_model';
import type { Rotation } from '../../../shared/geometry/rotation';
import { about, after } from '../../../shared/geometry/rotation';
import { laidOn, placedOn, rotationOf, sides, stanceOf } from './stance';

const machine = { clamp_opening_x_mm: 220, clamp_opening_y_mm: 180 };
const standard = { up: [0, 1, 0], turn_deg: 0, size_mm: null, x_mm: 0, y_mm: 0, sink_mm: 0, ...machine };
const asInFile = rotationOf({ up: [0, 1, 0], turn_deg: 0 }) as Rotation;

/** Sizes that turning sets are rounded to 0.01 mm. */
const sizeStep_mm = 0.0051;

/** Six corners, unlike an octahedron's in their distances, so that every side is another one. */
const corners = Float32Array.from([-30, 0, 0, 41, 3, 0, 0, -22, 1, 2, 60, 0, 0, 0, -35, 1, 0, 28]);

function expectOnItsSides(positions: ArrayLike<number>, least: number): void {
  const found = findFlatSides(positions);
  expect(found.length).toBeGreaterThanOrEqual(least);
  const start: JsonObject = { ...standard, turn_deg: 25, x_mm: 7 };
  const before = placeModel(start, positions) ?? expect.fail('not placed');
  for (const { normal, support } of found) {
    const changes = stoodOtherwise(start, positions, placedOn(rotationIn(start) as Rotation, normal));
    const now = placeModel({ ...start, ...changes }, positions) ?? expect.fail('not placed');
    const size_mm = now.scale * now.extent;
    for (const point of support) expect(Math.abs(pointAt(now.matrix, point)[2])).toBeLessThan(1e-6 * size_mm);
    const { low, high } = boxOf(placed(positions, now.matrix));
    expect(Math.abs(low[2])).toBeLessThan(1e-6 * size_mm);
    // As large as before, and its outline in the same place.
    expect(Math.abs(now.scale / before.scale - 1) * size_mm).toBeLessThan(sizeStep_mm);
    expect((low[0] + high[0]) / 2).toBeCloseTo(7, 3);
    expect((low[1] + high[1]) / 2).toBeCloseTo(0, 3);
  }
}

describe('standing a model otherwise', () => {
  it('lets an octahedron lie on each of its eight faces', () => {
    expect(findFlatSides(corners)).toHaveLength(8);
    expectOnItsSides(corners, 8);
  });

  it('does not change how large the model is, be its size set or automatic', () => {
    for (const size_mm of [null, 80])
      for (const unit of [1, 0.01, 9]) {
        const positions = corners.map((value) => unit * value);
        const start = { ...standard, size_mm };
        const before = placeModel(start, positions) ?? expect.fail('not placed');
        for (const rotation of [
          ...(['left', 'front', 'top'] as const).map((side) => laidOn(asInFile, side)),
          after(about([0, 1, 0], 37), asInFile),
        ]) {
          const now = placeModel({ ...start, ...stoodOtherwise(start, positions, rotation) }, positions);
          expect(Math.abs((now?.scale ?? 0) / before.scale - 1) * 100).toBeLessThan(sizeStep_mm);
        }
      }
  });

  it('leaves an automatic size automatic where it comes to the same', () => {
    const fits = stoodOtherwise(standard, corners, laidOn(asInFile, 'left'));
    expect(fits).not.toHaveProperty('size_mm');
    // 185 mm high in the file: as it stands it fits the opening; lying it would be made 100 mm by the automatic size.
    const tall = Float32Array.from([0, 0, 0, 90, 0, 0, 0, 185, 0, 0, 0, 90]);
    expect(placeModel(standard, tall)?.scale).toBe(1);
    expect(stoodOtherwise(standard, tall, laidOn(asInFile, 'front'))).toHaveProperty('size_mm', 185);
    expect(placeModel({ ...standard, up: [0, 0, 1] }, tall)?.scale).toBeCloseTo(100 / 185, 9);
  });

  it('chooses a size that leaves a margin to the clamp', () => {
    const cube = (side: number) => Float32Array.from([0, 0, 0, side, 0, 0, 0, side, 0, 0, 0, side]);
    const size_mm = (side: number, opening_mm: number) =>
      side *
      (placeModel({ ...standard, clamp_opening_x_mm: opening_mm, clamp_opening_y_mm: 300 }, cube(side))
        ?.scale ?? 0);
    expect(size_mm(190, 200)).toBeCloseTo(190, 4);
    expect(size_mm(191, 200)).toBeCloseTo(100, 4);
    expect(size_mm(1, 80)).toBeCloseTo(70, 4);
    expect(size_mm(40, 8)).toBeCloseTo(0.8, 4);
  });

  it('refuses what the core refuses', () => {
    expect(placeModel({ ...standard, up: [0, 0, 0] }, corners)).toBeNull();
    expect(placeModel(standard, [1, 1, 1, 1, 1, 1])).toBeNull();
  });
});

const module = fileURLToPath(new URL('../../../../public/wasm/formwright.mjs', import.meta.url));

describe.skipIf(!existsSync(module))('the page and the core', { timeout: 120_000 }, () => {
  const said: FromWorker[] = [];
  const runner = new WasmRunner(
    (message) => said.push(message),
    async (url) => ((await import(/* @vite-ignore */ url)) as { default: ModuleFactory }).default,
  );
  const run = async (job: Parameters<typeof runner.handle>[0] & { type: 'run' }) => {
    await runner.handle(job);
    const last = said.at(-1);
    if (last?.type !== 'done') throw new Error(JSON.stringify(last));
    return last;
  };
  let bust = new Float32Array(0);
  let sha256 = '';
  beforeAll(async () => {
    await runner.handle({ type: 'load', url: module, cancelFlag: null });
    const done = await run({
      type: 'run',
      id: 1,
      job: {
        operation: 'import',
        parameters: {},
        inputs: { mesh: { sample: 'bust', vertices: 3000 } },
        outputs: ['model.ply'],
      },
    });
    const model = done.outputs['model.ply']?.data ?? expect.fail('no model.ply');
    bust = new Float32Array(parsePly(model).positions);
    sha256 = await sha256Hex(model);
    await runner.handle({ type: 'blob', sha256, bytes: model });
  }, 120_000);

  it('lets the bust lie on every flat side of its hull', () => expectOnItsSides(bust, 3));

  const rotations: [string, Rotation][] = [
    ['as in the file', asInFile],
    ...(Object.keys(sides) as (keyof typeof sides)[]).map(
      (side) => [`on its ${side}`, laidOn(asInFile, side)] as [string, Rotation],
    ),
    ['leaning and turned', after(about([0.6, 0, 0.8], 70), asInFile)],
  ];
  it.each(rotations)('put the bust in the same place, %s', async (_, rotation) => {
    const { up, turn_deg } = stanceOf(rotation);
    for (const size_mm of [null, 77]) {
      const values = { up: [...up], turn_deg, size_mm, x_mm: 4, y_mm: -3, sink_mm: 2 };
      const { report } = await run({
        type: 'run',
        id: said.length,
        job: {
          operation: 'thermoform-simulate',
          parameters: { ...values, ...machine, triangles: 200 },
          inputs: { mould: { sha256, file_name: 'model.ply' } },
          outputs: [],
        },
      });
      const ours = placeModel({ ...values, ...machine }, bust)?.matrix ?? [];
      const theirs = report['placement'] as number[];
      expect(theirs).toHaveLength(16);
      ours.forEach((value, i) => expect(Math.abs(value - (theirs[i] ?? NaN))).toBeLessThan(1e-4));
    }
  });
});
