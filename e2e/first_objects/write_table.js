// SPDX-License-Identifier: GPL-3.0-or-later
// npm run actions, its second half: writes what first_objects.spec.ts measured into docs/page.md, between the two markers.
// Fails where a row was not measured, or misses the goal without a reason in rows.json.
import { readFileSync, writeFileSync } from 'node:fs';
import { cpus, loadavg } from 'node:os';
import { resolve } from 'node:path';

const goal = { actions: 8, seconds: 300 };
const [begin, end] = ['<!-- npm run actions: begin -->', '<!-- npm run actions: end -->'];
const here = import.meta.dirname;
const document = resolve(here, '../../docs/page.md');
const rows = JSON.parse(readFileSync(resolve(here, 'rows.json'), 'utf8'));

/** "Open a file; choose ball.obj; Relief": the same thing twice running is one with ×2. */
function words(actions) {
  const phrases = [];
  for (const { kind, what } of actions) {
    const text =
      { files: `choose ${what}`, drag: `drag “${what}”`, text: `type into “${what}”`, key: `\`${what}\`` }[
        kind
      ] ?? what;
    const last = phrases.at(-1);
    if (last?.text === text) ++last.times;
    else phrases.push({ text, times: 1 });
  }
  return phrases.map(({ text, times }) => (times > 1 ? `${text} ×${times}` : text)).join('; ');
}

const lines = rows.map(({ row, task, before, reason }) => {
  const measured = JSON.parse(readFileSync(resolve(here, '../test-results/actions', `${row}.json`), 'utf8'));
  const [actions, seconds] = [measured.actions.length, Math.round(measured.seconds)];
  const missed = actions > goal.actions || seconds > goal.seconds;
  if (missed && !reason)
    throw new Error(`${row} took ${actions} actions and ${seconds} s: rows.json must say why.`);
  const marked = (text) => (missed ? `**${text}**` : `${text}`);
  const why = missed ? ` **${reason}**` : '';
  return `| ${marked(task)} | ${before} | ${marked(actions)} | ${marked(seconds)} | ${words(measured.actions)}.${why} |`;
});
const [cpu] = cpus();
const table = [
  '| task | before | actions | seconds | what they are |',
  '|---|---:|---:|---:|---|',
  ...lines,
  '',
  `Measured on ${cpus().length} cores of an ${cpu?.model ?? 'unknown processor'}, load ${Math.round(loadavg()[2] ?? 0)}, without a graphics card, solving in the page.`,
];
const text = readFileSync(document, 'utf8');
const [from, to] = [text.indexOf(begin), text.indexOf(end)];
if (from < 0 || to < from) throw new Error(`docs/page.md has no ${begin} before ${end}.`);
writeFileSync(document, `${text.slice(0, from)}${begin}\n${table.join('\n')}\n${text.slice(to)}`);
