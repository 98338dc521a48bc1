// SPDX-License-Identifier: GPL-3.0-or-later
// The words that the page says: those in its sources, and the labels and help texts of the catalog.
//   node web/scripts/page_strings.js 40 7     draws 40 of them with seed 7, to be judged as a stranger would
/* global console */
import { readdirSync, readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import process from 'node:process';
import ts from 'typescript';

const root = resolve(import.meta.dirname, '../..');

/** Attributes of elements that hold no words. */
const wordless =
  /^(class|buttonClass|id|key|style|href|src|type|kind|icon|d|viewBox|role|name|accept|keys|for|transform|size|align|inputMode|autocomplete)$/;
/** Properties of objects that hold words, however short. */
const wordy =
  /^(label|title|titles|pitch|makes|hint|legend|action|help|detail|text|name|message|done|empty|failed|solving|opening|exporting)$/;

/** A placeholder of a template; in a pattern it stands for any words. */
export const gap = '\u2026';

const squeeze = (text) => text.replaceAll(/\s+/g, ' ').trim();

function templateText(node) {
  return squeeze(node.head.text + node.templateSpans.map((span) => gap + span.literal.text).join(''));
}

/** Said by itself: begins with a capital letter, or is several words. */
const looksSaid = (text) =>
  (/^[“]?[A-Z\u2026][\p{L}\d \u2026’“”:;,.()×%–?!/+-]*$/u.test(text) && /[a-z]{2}/.test(text)) ||
  /\p{L}{2,} \p{L}{2,} \p{L}/u.test(text);
const isCode = (text) =>
  /[{}<>=]|^\W*$|^[a-z-]+\/|\.(ts|js|css)\b|^(Content|Authorization|Bearer|ArrowUp|ArrowDown|ArrowLeft|ArrowRight|Backspace|Delete|Enter|Escape|Home|End|PageUp|PageDown|Control)/.test(
    text,
  );

/** Not the tail of a sentence, a file name or the name of an error. */
const isSaid = (text) =>
  text.replaceAll(/[^\p{L}]/gu, '').length >= 3 &&
  !/^[,.;)]|^\u2026?-|\u2026px|^\u2026?\/|(Error|Refusal)$|^\u2026?\.\w+$/.test(text);

function wordsOfElement(node) {
  const pieces = node.children.map((child) =>
    ts.isJsxText(child)
      ? child.text
      : ts.isJsxExpression(child) && child.expression && ts.isStringLiteral(child.expression)
        ? child.expression.text
        : gap,
  );
  const text = squeeze(pieces.join('').replaceAll(/\u2026(\s*\u2026)+/g, gap));
  return node.children.some((child) => ts.isJsxText(child) && /\p{L}{2}/u.test(child.text)) ? text : '';
}

/** Of one source file, in order. */
export function stringsIn(path, source) {
  const file = ts.createSourceFile(
    path,
    source,
    ts.ScriptTarget.ESNext,
    true,
    path.endsWith('x') ? ts.ScriptKind.TSX : ts.ScriptKind.TS,
  );
  const found = [];
  const visit = (node) => {
    if (ts.isImportDeclaration(node) || ts.isExportDeclaration(node) || ts.isLiteralTypeNode(node)) return;
    if (ts.isJsxAttribute(node) && wordless.test(node.name.getText())) return;
    if (ts.isBinaryExpression(node) && /^[!=]==?$/.test(node.operatorToken.getText())) {
      if (!ts.isStringLiteralLike(node.left)) visit(node.left);
      if (!ts.isStringLiteralLike(node.right)) visit(node.right);
      return;
    }
    if (ts.isElementAccessExpression(node) || ts.isCaseClause(node)) {
      if (ts.isCaseClause(node)) node.statements.forEach(visit);
      else visit(node.expression);
      return;
    }
    if (ts.isJsxElement(node) || ts.isJsxFragment(node)) found.push(wordsOfElement(node));
    if (ts.isStringLiteralLike(node) || ts.isTemplateExpression(node)) {
      const text = ts.isTemplateExpression(node) ? templateText(node) : squeeze(node.text);
      const { parent } = node;
      const named = ts.isPropertyAssignment(parent) && wordy.test(parent.name.getText());
      const attribute = ts.isJsxAttribute(parent);
      if (!isCode(text) && ((/^[A-Z]/.test(text) && (named || attribute)) || looksSaid(text)))
        found.push(text);
    }
    ts.forEachChild(node, visit);
  };
  visit(file);
  return found.filter(isSaid);
}

/** Every source of the page that speaks: not tests, not what only draws, not the tutorials themselves. */
export function pageSources() {
  const folder = resolve(root, 'web/src');
  return readdirSync(folder, { recursive: true })
    .map(String)
    .filter(
      (path) =>
        /\.tsx?$/.test(path) &&
        !/\.test\.|^(view|fuzz|jobs\/mock)\/|test_room|app\/learn\/tutorials\//.test(path),
    )
    .sort()
    .map((path) => ({ path, source: readFileSync(resolve(folder, path), 'utf8') }));
}

export const pageStrings = () => [
  ...new Set(pageSources().flatMap(({ path, source }) => stringsIn(path, source))),
];

/** Labels, choices, groups, help texts, titles and summaries. */
export function catalogStrings() {
  const catalog = JSON.parse(readFileSync(resolve(root, 'tests/job/catalog.json'), 'utf8'));
  const found = [];
  for (const operation of catalog.operations) {
    found.push(operation.title, operation.summary);
    for (const schema of Object.values(operation.parameters.properties))
      found.push(schema.title, schema.description, schema['x-group'], ...(schema['x-choice-labels'] ?? []));
    for (const output of operation.outputs) found.push(output.label);
  }
  found.push(...catalog.samples.map(({ title }) => title));
  found.push(...catalog.laser_materials.materials.map(({ title }) => title));
  return [...new Set(found.filter(Boolean))];
}

/** What the core calls the causes that a diagnosis knows, as a recorded job has them. */
export function causeStrings() {
  const { recorded } = JSON.parse(
    readFileSync(resolve(root, 'tests/jobs/evidence_diagnose_pyramid.json'), 'utf8'),
  );
  return recorded.report.causes.map(({ label }) => label);
}

/** The same draw for the same seed (Lehmer's generator). */
export function draw(strings, count, seed) {
  const rest = [...strings].sort();
  let state = (seed * 48271) % 2147483647 || 1;
  const drawn = [];
  while (drawn.length < count && rest.length > 0) {
    state = (state * 48271) % 2147483647;
    drawn.push(...rest.splice(state % rest.length, 1));
  }
  return drawn;
}

if (process.argv[1] === import.meta.filename) {
  const [count, seed] = [Number(process.argv[2] ?? 40), Number(process.argv[3] ?? 1)];
  const strings = [...pageStrings(), ...catalogStrings()];
  console.log(`${strings.length} strings; ${count} drawn with seed ${seed}`);
  draw(strings, count, seed).forEach((text, i) => console.log(`${String(i + 1).padStart(2)}  ${text}`));
}
