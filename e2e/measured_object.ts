// SPDX-License-Identifier: GPL-3.0-or-later
// A measured object for the stories: what the command line's own simulation has with a heater that is hot on one side.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { fileOf } from './page';

const program = process.env['FORMWRIGHT'] ?? resolve(import.meta.dirname, '../build/formwright');

const mould = `v -25 -25 0\nv 25 -25 0\nv 25 25 0\nv -25 25 0\nv -8 -8 25\nv 8 -8 25\nv 8 8 25\nv -8 8 25
f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 7 8\n`;
const setup = {
  sheet_mm: [130, 130],
  sheet_thickness_mm: 1,
  clamp_opening_mm: [110, 110],
  clamp_height_mm: 1,
  base_plate_start_z_mm: -60,
  base_plate_end_z_mm: 0,
  mould_speed_mm_per_s: 100,
  relaxation_s: 1,
  vacuum_kpa: 80,
  density_kg_per_m3: 1330,
  poisson_ratio: 0.35,
  measured_surface: 'mid',
};
const header = 'sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,sigma_mm';

/** Rows of measured.csv without their header. `gradient`: how much colder, so stiffer, the right side is. */
function simulated(gradient: number): number[][] {
  const folder = mkdtempSync(join(tmpdir(), 'formwright-object-'));
  try {
    const places: number[][] = [];
    for (let x = -52; x < 53; x += 8) for (let y = -52; y < 53; y += 8) places.push([x, y]);
    writeFileSync(join(folder, 'mould.obj'), mould);
    writeFileSync(join(folder, 'setup.json'), JSON.stringify(setup));
    const flat = places.map(([x = 0, y = 0]) => [x, y, x, y, 1, 0.05].join());
    writeFileSync(join(folder, 'measured.csv'), [header, ...flat, ''].join('\n'));
    const out = join(folder, 'out');
    const flags = [
      '--triangles',
      '1500',
      '--young-modulus-pa',
      '3.4e6',
      '--heating-gradient-x',
      String(gradient),
    ];
    execFileSync(program, ['thermoform-compare', '--object', folder, '--out', out, '--quiet', ...flags]);
    const rows = readFileSync(join(out, 'residuals.csv'), 'utf8').trim().split('\n').slice(1);
    return rows.map((row) => row.split(',').map(Number));
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
}

/** A dome whose texture coordinates are the flat sheet's own, its picture and pattern: a scan without a camera. */
export function scannedSheet() {
  const folder = mkdtempSync(join(tmpdir(), 'formwright-scan-'));
  try {
    const sizes = { 'sheet-x-mm': 90, 'sheet-y-mm': 100, 'clamp-opening-x-mm': 78, 'clamp-opening-y-mm': 88 };
    const flags = Object.entries({ ...sizes, 'coarsest-mm': 20, seed: 5, 'dots-per-inch': 250 });
    const words = flags.flatMap(([name, value]) => [`--${name}`, String(value)]);
    execFileSync(program, ['evidence-pattern', ...words, '--out', folder, '--quiet']);
    const lines: string[] = [];
    const [n, width, length] = [45, 90, 100];
    for (let j = 0; j <= n; ++j)
      for (let i = 0; i <= n; ++i) {
        const [x, y] = [width * (i / n - 0.5), length * (j / n - 0.5)];
        const share = Math.min(1, (x * x + y * y) / 34 ** 2);
        lines.push(`v ${x} ${y} ${1.5 + 9 * (1 - share) ** 2}`, `vt ${i / n} ${j / n}`);
      }
    for (let j = 0; j < n; ++j)
      for (let i = 0; i < n; ++i) {
        const a = j * (n + 1) + i + 1;
        const [b, c, d] = [a + 1, a + n + 2, a + n + 1];
        lines.push(`f ${a}/${a} ${b}/${b} ${c}/${c}`, `f ${a}/${a} ${c}/${c} ${d}/${d}`);
      }
    const made = (name: string, mimeType: string) => ({
      name,
      mimeType,
      buffer: readFileSync(join(folder, name)),
    });
    return {
      scan: fileOf('scan.obj', lines.join('\n')),
      picture: made('pattern.png', 'image/png'),
      pattern: made('pattern.json', 'application/json'),
    };
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
}

/** Noise of 0.05 mm that is the same every time (Lehmer's generator, twelve uniform numbers a normal one). */
function noisy(rows: number[][]): number[][] {
  let state = 7;
  const draw = () => (state = (state * 48271) % 2147483647) / 2147483647;
  const normal = () => 0.05 * (Array.from({ length: 12 }, draw).reduce((a, b) => a + b, 0) - 6);
  return rows.map(([x = 0, y = 0, , , , u = 0, v = 0, w = 0]) => [
    x,
    y,
    u + normal(),
    v + normal(),
    w + normal(),
  ]);
}

const points = new Map<number, number[][]>();

/** The three files; `unit` 0.001 measures in metres by mistake, `gradient` 0 is a part without fault. */
export function measuredObject(unit = 1, gradient = 0.35) {
  const known = points.get(gradient) ?? noisy(simulated(gradient));
  points.set(gradient, known);
  const rows = known.map(([x = 0, y = 0, ...place]) =>
    [x, y, ...place.map((value) => (unit * value).toFixed(7)), 0.05].join(),
  );
  return [
    fileOf('mould.obj', mould),
    fileOf('setup.json', JSON.stringify(setup)),
    fileOf('measured.csv', [header, ...rows, ''].join('\n')),
  ] as const;
}
