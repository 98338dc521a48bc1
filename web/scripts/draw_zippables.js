// SPDX-License-Identifier: GPL-3.0-or-later
// npm run zippables [SAMPLE]: makes docs/zippable_gallery.md anew, its pictures and its figures, with the native build and the
// system's Chromium. Some minutes.
/* global Buffer, console */
import { chromium } from '@playwright/test';
import { execFileSync, execSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { createServer } from 'vite';

const web = resolve(import.meta.dirname, '..');
const docs = resolve(web, '../docs');
const program = resolve(web, '../build/formwright');

/** Sizes of the thesis's own pieces (5.4); ribbons of about an eighth of it, wider than theirs, which simulate in a minute. */
const rows = [
  { sample: 'star', size_mm: 270, width_mm: 37, theirs: '2.25 m at 27 cm (Fig. 5.2)' },
  { sample: 'heart', size_mm: 150, width_mm: 22, theirs: '3.5 m at 15 cm; sides 0.2 mm apart (Fig. 5.18)' },
  { sample: 't_shape', size_mm: 500, width_mm: 75, theirs: 'about 10 m at 50 cm (Fig. 5.5)' },
  { sample: 'octopus', size_mm: 500, width_mm: 70, theirs: 'nine parts (Fig. 5.23)' },
  { sample: 'cat', size_mm: 500, width_mm: 75, theirs: 'about 10 m at 50 cm (sewn pieces)' },
  { sample: 'torus', size_mm: 500, width_mm: 75, theirs: 'handle cut open (Fig. 5.3)' },
];

const folder = mkdtempSync(join(tmpdir(), 'formwright-zippables-'));
const run = (operation, out, ...words) => {
  execFileSync(program, [operation, ...words.map(String), '--out', join(folder, out)], { stdio: 'pipe' });
  return JSON.parse(readFileSync(join(folder, out, 'report.json'), 'utf8'));
};
const text = (name) => readFileSync(join(folder, name), 'utf8');
const base64 = (name) => readFileSync(join(folder, name)).toString('base64');
const bed = ['--bed-x-mm', 900, '--bed-y-mm', 600];

function make({ sample, size_mm, width_mm, theirs }) {
  const size = ['--size-mm', size_mm, '--width-mm', width_mm];
  const designed = run('zippable-design', 'design', '--sample', sample, ...size);
  const design = ['--design', join(folder, 'design/design.json')];
  const planned = run('zippable-plan', 'plan', ...design, ...bed);
  const glued = run('zippable-plan', 'glued', ...design, ...bed, '--method', 'gluing');
  const zipped = run('zippable-simulate', 'zipped', ...design);
  const strips = run('zippable-baseline', 'strips', '--sample', sample, ...size, ...bed);
  return { sample, size_mm, width_mm, theirs, designed, planned, glued, zipped, strips };
}

const number = (value, digits = 2) =>
  Number(value)
    .toPrecision(digits)
    .replace(/e\+?(-?\d+)$/, '·10^$1');
const table = (head, lines) =>
  [head, head.map((_, i) => (i === 0 ? '---' : '---:')), ...lines]
    .map((line) => `| ${line.join(' | ')} |`)
    .join('\n');

function page(made) {
  const figures = made.map(({ sample, size_mm, width_mm, theirs, designed: d, planned, strips }) => [
    sample,
    size_mm,
    width_mm,
    d.parts,
    d.iterations,
    number(d.seconds_parameterisation),
    (d.zipper_length_mm / 1000).toFixed(2),
    number(d.ribbon_width_min_mm),
    number(d.ribbon_to_model_mean_mm),
    number(Math.max(d.ribbon_to_model_max_mm, d.model_to_ribbon_max_mm)),
    planned.pieces.length,
    strips.pieces.length ?? strips.pieces,
    theirs,
  ]);
  const zips = made.map(({ sample, zipped: z, glued: g }) => [
    sample,
    z.verdict,
    number(z.distance_mean_mm),
    number(z.distance_95_mm),
    number(z.rest_distance_95_mm),
    number(Math.abs(g.left_length_mm - g.right_length_mm)),
    `${Math.round(100 * g.binormal_share)} %`,
  ]);
  return `# Samples, from model to zipped cloth

Made by \`npm --prefix web run zippables\`, which runs \`zippable-design\`, \`-plan\`, \`-simulate\` and \`-baseline\` with default settings on a bed of 900 by 600 mm. From the left: the model,
parts and the zipper's course, the flat ribbon, its pieces on sheets, the cloth as it is simulated zipped up (red: a twentieth of its size away from the design).
${made.map(({ sample }) => `\n![${sample}](img/zippable_${sample}.webp)`).join('\n')}

## Figures
mm and seconds; "mean" and "Hausdorff" are distances between ribbon and model, "strips" the pieces in the manner of [MS04] ([zippable_baseline.md](zippable_baseline.md)).
Seconds are those of the parameterisation. The thesis: at most 15 iterations and about 20 s for 30,000 triangles; its bunny has 7 pieces against 15 of [MS04] (Fig. 5.21). Its models are not these.

${table(['sample', 'size', 'width', 'parts', 'iterations', 'seconds', 'zipper, m', 'narrowest', 'mean', 'Hausdorff', 'pieces', 'strips', 'thesis'], figures)}

Zipped up ([zippable_simulation.md](zippable_simulation.md)), and glued: how far the two sides of the glued zipper differ in length, and how much of it follows the binormal.

${table(['sample', 'will it zip?', 'mean', '95 %', '95 % at rest', 'sides differ', 'binormal'], zips)}

The cloth is 0.5 mm thick whatever the size: octopus and cat of 500 mm wrinkle. At 100 mm with a ribbon of 15 mm all six take their shape
([zippable_simulation.md](zippable_simulation.md)). The torus' cut handle is closed with hook-and-loop tape.
`;
}

const server = await createServer({ root: web, server: { port: 5651, strictPort: true, host: '127.0.0.1' } });
await server.listen();
const browser = await chromium.launch({
  executablePath: execSync('command -v chromium || command -v google-chrome', { encoding: 'utf8' }).trim(),
  args: ['--headless=new', '--no-sandbox'],
});
try {
  const view = await browser.newPage();
  await view.goto('http://127.0.0.1:5651/#/about');
  const made = [];
  for (const row of rows) {
    if (process.argv[2] !== undefined && process.argv[2] !== row.sample) continue;
    made.push(make(row));
    const picture = readFileSync(resolve(web, `public/pictures/${row.sample}.webp`)).toString('base64');
    const url = await view.evaluate(
      async (files) => (await import('/scripts/in_page/draw_zippables.ts')).drawRow(files),
      {
        model: `data:image/webp;base64,${picture}`,
        parameterised_ply: base64('design/parameterised.ply'),
        curve_obj: text('design/curve.obj'),
        ribbon_svg: text('design/ribbon.svg'),
        plan_svg: text('plan/plan.svg'),
        zipped_ply: base64('zipped/zipped.ply'),
      },
    );
    const bytes = Buffer.from(url.slice(url.indexOf(',') + 1), 'base64');
    writeFileSync(join(docs, `img/zippable_${row.sample}.webp`), bytes);
    console.log(`zippable_${row.sample}.webp  ${bytes.length} bytes`);
    if (process.argv[2] === undefined) writeFileSync(join(docs, 'zippable_gallery.md'), page(made));
  }
  if (process.argv[2] !== undefined) console.log(page(made));
} finally {
  await browser.close();
  await server.close();
  rmSync(folder, { recursive: true, force: true });
}
