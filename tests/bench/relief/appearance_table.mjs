// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of docs/relief.md from what compare_appearance printed:
//   compare_appearance MODEL... > a.json; node appearance_table.mjs a.json [b.json...]
import { readFileSync } from 'node:fs';

const rows = process.argv.slice(2).flatMap((file) => JSON.parse(readFileSync(file, 'utf8')).rows);
const methods = [...new Set(rows.map((row) => row.method))];
const mean = (values) => values.reduce((a, b) => a + b, 0) / values.length;
const of = (method, test = () => true) => rows.filter((row) => row.method === method && test(row));
const table = (head, lines) => [head, head.map(() => '---'), ...lines].map((line) => `| ${line.join(' | ')} |`).join('\n');

const percents = [...new Set(rows.map((row) => row.percent))].sort((a, b) => a - b);
console.log(table(['method', ...percents.map((p) => `1 - likeness at ${p} %`), 'angle, °', 'false edges, %', 'seconds'],
  methods.map((method) => [method, ...percents.map((p) => mean(of(method, (row) => row.percent === p).map((row) => 1 - row.similarity)).toFixed(3)),
    mean(of(method).map((row) => row.normal_error_mean_deg_image)).toFixed(1), mean(of(method).map((row) => row.false_edges_percent)).toFixed(3),
    mean(of(method).map((row) => row.processor_seconds)).toFixed(2)])));
console.log();
const cases = [...new Set(rows.map((row) => `${row.model}|${row.vertices}`))];
console.log(table(['model', 'vertices', ...methods], cases.map((key) => {
  const [model, vertices] = key.split('|');
  const shown = (method) => percents.map((p) => of(method, (row) => row.model === model && row.percent === p)
    .map((row) => row.similarity.toFixed(3)).join(' ')).join(' / ');
  return [model, Number(vertices).toLocaleString('en'), ...methods.map(shown)];
})));
