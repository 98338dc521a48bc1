// SPDX-License-Identifier: GPL-3.0-or-later
// @vitest-environment node
// What docs/tutorials/ says is what the page does. WRITE_TUTORIALS=1 writes the steps into the documents.
import { existsSync, readdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { describe, expect, it } from 'vitest';
import { catalogStrings, causeStrings, gap, pageStrings } from '../../../scripts/page_strings.js';
import type { Tutorial } from './tutorial';
import { labelsIn } from './tutorial';
import { tutorials } from './tutorials';

const path = (relative: string) => fileURLToPath(new URL(`../../../../docs/${relative}`, import.meta.url));
const documentOf = ({ name }: Tutorial) => path(`tutorials/${name}.md`);
const [begin, end] = ['<!-- steps: written by npm run tutorials -->', '<!-- end of steps -->'];

const stepsOf = ({ steps }: Tutorial): string =>
  steps
    .map(({ text, picture }, i) => {
      const shown = picture ? `\n\n   ![${picture.alt}](../img/tutorials/${picture.name}.png)\n` : '';
      return `${i + 1}. ${text}${shown}`;
    })
    .join('\n');

function withSteps(document: string, tutorial: Tutorial): string {
  const [head, rest] = document.split(begin);
  const tail = rest?.split(end)[1];
  if (head === undefined || tail === undefined)
    throw new Error(`${tutorial.name}.md lacks the marks of its steps.`);
  return `${head}${begin}\n${stepsOf(tutorial)}\n${end}${tail}`;
}

/** Said by the page as it is, or with other words in the gaps of a template. */
const spoken = (() => {
  const strings = [...pageStrings(), ...catalogStrings(), ...causeStrings()];
  const exact = new Set(strings);
  const patterns = strings
    .filter((text) => text.includes(gap) && text.replaceAll(/[^\p{L}]/gu, '').length >= 4)
    .map((text) => new RegExp(`^${text.split(gap).map(escaped).join('.+')}$`, 'u'));
  return (label: string) => exact.has(label) || patterns.some((pattern) => pattern.test(label));
})();
function escaped(text: string): string {
  return text.replaceAll(/[.*+?^${}()|[\]\\]/g, '\\$&');
}

describe.each(tutorials)('$name', (tutorial) => {
  it('has its steps in its document; npm run tutorials writes them', () => {
    const file = documentOf(tutorial);
    const document = readFileSync(file, 'utf8');
    const expected = withSteps(document, tutorial);
    if (process.env['WRITE_TUTORIALS'] === '1') writeFileSync(file, expected);
    else expect(document).toBe(expected);
  });

  it('names only what the page says', () => {
    const unknown = [...new Set(labelsIn(readFileSync(documentOf(tutorial), 'utf8')))].filter(
      (label) => !spoken(label),
    );
    expect(unknown).toEqual([]);
  });

  it('has a picture at least every third step, none too large', () => {
    const pictures = tutorial.steps.flatMap(({ picture }) => (picture ? [picture.name] : []));
    expect(pictures.length).toBeGreaterThanOrEqual(Math.floor(tutorial.steps.length / 4));
    for (const name of pictures) {
      const file = path(`img/tutorials/${name}.png`);
      expect(existsSync(file), `${name}.png: npm run tutorials takes it`).toBe(true);
      expect(statSync(file).size, `${name}.png`).toBeLessThan(155_000);
    }
  });
});

it('keeps no picture that no tutorial shows', () => {
  const documents = readdirSync(path('tutorials')).map((name) =>
    readFileSync(path(`tutorials/${name}`), 'utf8'),
  );
  const unused = readdirSync(path('img/tutorials')).filter(
    (name) => !documents.some((text) => text.includes(name)),
  );
  expect(unused).toEqual([]);
});

it('would notice a label that the page does not have', () => {
  expect(spoken('Solve at full detail')).toBe(true);
  expect(spoken('Export STL')).toBe(true);
  expect(spoken('Solve at once')).toBe(false);
});
