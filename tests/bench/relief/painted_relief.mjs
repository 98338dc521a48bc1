// SPDX-License-Identifier: GPL-3.0-or-later
// The table of docs/relief.md, "Painting": one bust, painted in several ways.
//   node painted_relief.mjs build/formwright
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';

const program = process.argv[2];
const folder = mkdtempSync(path.join(tmpdir(), 'painted-relief-'));
const run = (name, ...flags) => {
  const out = path.join(folder, name);
  execFileSync(program, [...flags, '--out', out], { stdio: 'ignore' });
  return { out, report: JSON.parse(readFileSync(path.join(out, 'report.json'), 'utf8')) };
};

/** Numbers of the vertices of a PLY file as Formwright writes it: little endian. */
function columnsOf(file) {
  const bytes = readFileSync(file);
  const end = bytes.indexOf('end_header\n') + 11;
  const header = bytes.subarray(0, end).toString().split('\n');
  const count = Number(header.find((line) => line.startsWith('element vertex')).split(' ')[2]);
  const faces = header.findIndex((line) => line.startsWith('element face'));
  const properties = header.slice(0, faces).filter((line) => line.startsWith('property')).map((line) => line.split(' ').slice(1));
  const readers = { double: ['readDoubleLE', 8], float: ['readFloatLE', 4], uchar: ['readUInt8', 1], int: ['readInt32LE', 4] };
  const columns = Object.fromEntries(properties.map(([, name]) => [name, []]));
  let at = end;
  for (let v = 0; v < count; ++v)
    for (const [type, name] of properties) {
      const [read, size] = readers[type];
      columns[name].push(bytes[read](at));
      at += size;
    }
  return columns;
}

const model = path.join(run('model', 'import', '--sample', 'bust', '--sample-vertices', '20000').out, 'model.ply');
const { x, y, z } = columnsOf(model);
const relief = (name, painting) => {
  const file = path.join(folder, `${name}.json`);
  writeFileSync(file, JSON.stringify({ vertices: x.length, ...painting }));
  const { out, report } = run(name, 'relief', '--mesh', model, '--painting', file);
  return { report, columns: columnsOf(path.join(out, 'relief.ply')) };
};
const plain = relief('plain', {});
const range = (values) => [Math.min(...values), Math.max(...values)];
const [low, high] = range(y);
const height = (v) => (y[v] - low) / (high - low);
const isHead = x.map((_, v) => height(v) > 0.45);
const isFace = x.map((_, v) => isHead[v] && z[v] > 0 && plain.columns.visible[v] === 1);
const isRim = x.map((_, v) => height(v) < 0.15);

const paintings = [
  ['nothing', {}],
  ['the face matters 4 times as much', { weight: isFace.map((face) => (face ? 4 : 1)) }],
  ['the face matters a quarter', { weight: isFace.map((face) => (face ? 0.25 : 1)) }],
  ['the head may be 10 mm thick', { region: isHead.map((head) => (head ? 'own_thickness' : 'usual')), thickness_mm: isHead.map(() => 10) }],
  ['the head is free', { region: isHead.map((head) => (head ? 'free' : 'usual')) }],
  ['the lower edge lies on the base', { region: isRim.map((rim) => (rim ? 'on_base' : 'usual')) }],
];
const shading = ({ columns }, where) => {
  const errors = columns.normal_error_deg.filter((_, v) => where[v] && columns.visible[v] === 1);
  return (errors.reduce((sum, error) => sum + error, 0) / errors.length).toFixed(1);
};
console.log('| painted | shading difference of the face | of the rest | stands out | solved in | depth order conditions left out |\n|---|---:|---:|---:|---:|---:|');
for (const [name, painting] of paintings) {
  const made = relief(name.replaceAll(' ', '_'), painting);
  const { stands_out_max_mm, seconds_solve, order_rows, order_rows_left_out } = made.report;
  console.log(`| ${name} | ${shading(made, isFace)}° | ${shading(made, isFace.map((face) => !face))}° | ${stands_out_max_mm.toFixed(1)} mm | ${seconds_solve.toFixed(1)} s | ${order_rows_left_out} of ${order_rows + order_rows_left_out} |`);
}
rmSync(folder, { recursive: true });
