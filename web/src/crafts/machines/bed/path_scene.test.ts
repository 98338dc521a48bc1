// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { detailsOf } from '../../../machines/path_detail';
import type { ToolPath, ToolPathPart } from '../../../machines/toolpath';
import type { MeshData } from '../../../view';
import { blockEdges, blockOf, boardUnder, movedTo, pathCurves, toolMesh } from './path_scene';

const part = (
  kind: 'work' | 'travel',
  layer: string,
  points: readonly number[],
  from_s: number,
): ToolPathPart => ({
  kind,
  layer,
  part: '',
  pass: 1,
  power_percent: 100,
  speed_mm_per_s: 10,
  points_mm: points,
  times_s: Array.from({ length: points.length / 3 }, (_, i) => from_s + i),
  lines: Array.from({ length: points.length / 3 }, (_, i) => i),
});
const toolPath: ToolPath = {
  bed_mm: [100, 80],
  no_go_mm: [],
  seconds: 7,
  paths: [
    part('travel', '', [0, 0, 5, 10, 20, 5], 0),
    part('work', 'rough', [10, 20, 5, 10, 20, -1, 30, 20, -1], 1),
    part('work', 'finish', [30, 20, -1, 30, 50, -2.5], 3),
  ],
};

/** Volume inside a closed mesh whose triangles look outwards: positive. */
function volume({ positions, indices }: MeshData): number {
  let sum = 0;
  for (let t = 0; t < indices.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => {
      const v = 3 * (indices[t + k] ?? 0);
      return [positions[v] ?? 0, positions[v + 1] ?? 0, positions[v + 2] ?? 0] as const;
    }) as [
      readonly [number, number, number],
      readonly [number, number, number],
      readonly [number, number, number],
    ];
    sum +=
      (a[0] * (b[1] * c[2] - b[2] * c[1]) +
        a[1] * (b[2] * c[0] - b[0] * c[2]) +
        a[2] * (b[0] * c[1] - b[1] * c[0])) /
      6;
  }
  return sum;
}

describe('a tool path in space', () => {
  it('is lines apart, by layer, with the times at their ends', () => {
    const curves = pathCurves(toolPath, null, true);
    expect(curves.map(({ colour }) => colour)).toEqual(['--seg-a', '--seg-b', '--ink']);
    expect([...(curves[1]?.positions ?? [])]).toEqual([10, 20, 5, 10, 20, -1, 10, 20, -1, 30, 20, -1]);
    expect([...Array.from(curves[1]?.values ?? [])]).toEqual([1, 2, 2, 3]);
    expect(pathCurves(toolPath, null, false)).toHaveLength(2);
  });

  it('has as many pieces as may be drawn, and every layer', () => {
    const many: ToolPath = {
      ...toolPath,
      paths: Array.from({ length: 5000 }, (_, i) => part('work', 'engrave', [0, i, 0, 9, i, 0], i)),
    };
    const [curve] = pathCurves(many, null, true, 1000);
    expect((curve?.positions.length ?? 0) / 6).toBeLessThanOrEqual(1000);
    expect((curve?.positions.length ?? 0) / 6).toBeGreaterThan(900);
  });

  it('with fewer points begins and ends where the path does', () => {
    const points = Array.from({ length: 30_000 }, (_, i) => [0.01 * i, 0, Math.sin(0.01 * i)]).flat();
    const long: ToolPath = { ...toolPath, paths: [part('work', 'finish', points, 0)] };
    const detail = detailsOf(long)[0] ?? null;
    const [curve] = pathCurves(long, detail, true);
    expect((curve?.positions.length ?? 0) / 6).toBe((detail?.points ?? 0) - 1);
    expect(curve?.positions[0]).toBe(0);
    expect(curve?.positions.at(-3)).toBeCloseTo(299.99, 3);
    expect(Number(Array.from(curve?.values ?? []).at(-1))).toBe(29_999);
  });

  it('lies in a block of what is worked, over a board', () => {
    const block = blockOf(toolPath);
    expect(block).toEqual([
      [10, 20, -2.5],
      [30, 50, 0],
    ]);
    if (block === null) return;
    expect(blockEdges(block).positions).toHaveLength(12 * 6);
    const board = boardUnder(block);
    expect(volume(board)).toBeGreaterThan(0);
    for (let i = 2; i < board.positions.length; i += 3) expect(board.positions[i]).toBeLessThan(-2.5);
    expect(blockOf({ ...toolPath, paths: toolPath.paths.slice(0, 1) })).toBeNull();
  });

  it('has a tool of its shape, solid, with its tip at zero', () => {
    const form = { diameter_mm: 6, v_angle_degrees: 90, v_tip_mm: 0 };
    const circle = (24 / 2) * Math.sin((2 * Math.PI) / 24) * 9; // of the 24 corners
    expect(volume(toolMesh({ ...form, shape: 'flat' }))).toBeCloseTo(circle * 30, 6);
    expect(volume(toolMesh({ ...form, shape: 'v' }))).toBeCloseTo(circle * (30 + 1), 6); // a cone of height 3
    const ball = volume(toolMesh({ ...form, shape: 'ball' })) - circle * 27;
    expect(ball / ((2 / 3) * circle * 3)).toBeGreaterThan(0.97);
    expect(ball / ((2 / 3) * circle * 3)).toBeLessThanOrEqual(1);
    const moved = movedTo(toolMesh({ ...form, shape: 'flat' }).positions, [5, 6, -1]);
    expect(Math.min(...Array.from(moved).filter((_, i) => i % 3 === 2))).toBe(-1);
  });
});
