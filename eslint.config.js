// SPDX-License-Identifier: GPL-3.0-or-later
// One rule set for the page and its stories, and the directions in which the page's imports may point:
//   ui, jobs, view <- project <- machines <- shared <- crafts/<name> <- app.
import js from '@eslint/js';
import ts from 'typescript-eslint';

/** Forbids imports into the named folders of web/src/. */
const closed = (files, folders, message) => ({
  files,
  rules: {
    'no-restricted-imports': [
      'error',
      { patterns: [{ regex: `(^|/)(${folders.join('|')})(/|$)`, message, caseSensitive: true }] },
    ],
  },
});

export default ts.config(
  { ignores: ['build*', 'tests', '**/dist', 'web/public', '**/test-results', '**/playwright-report'] },
  js.configs.recommended,
  ...ts.configs.strict,
  {
    rules: {
      '@typescript-eslint/consistent-type-imports': 'error',
      '@typescript-eslint/no-unused-vars': ['error', { argsIgnorePattern: '^_', varsIgnorePattern: '^_' }],
      eqeqeq: 'error',
      'no-console': 'error',
      'prefer-const': 'error',
    },
  },
  {
    files: ['web/scripts/**', 'web/*.ts', 'e2e/**'],
    languageOptions: { globals: { process: 'readonly' } },
    rules: { 'no-console': 'off' },
  },
  closed(
    ['e2e/**'],
    ['web(?=$|/(?!src/app/learn/tutorial))'],
    'Stories see the page as a person does; of its code they know the steps of the tutorials alone.',
  ),
  closed(
    ['web/src/ui/**'],
    ['jobs', 'project', 'view', 'crafts', 'machines', 'app'],
    'ui/ knows no other folder.',
  ),
  closed(
    ['web/src/jobs/**'],
    ['ui', 'project', 'view', 'crafts', 'machines', 'app'],
    'jobs/ is the contract and its backends; it knows no other folder.',
  ),
  closed(
    ['web/src/view/**'],
    ['ui', 'jobs', 'project', 'crafts', 'machines', 'app'],
    'view/ knows meshes, not jobs or documents.',
  ),
  closed(
    ['web/src/project/**'],
    ['ui', 'view', 'crafts', 'machines', 'app'],
    'project/ may use jobs/contract and nothing else.',
  ),
  closed(
    ['web/src/shared/**'],
    ['crafts', 'app'],
    'shared/ is what crafts have in common; it knows none of them.',
  ),
  closed(
    ['web/src/crafts/relief/**'],
    ['app', 'machines', 'crafts', 'thermoform', 'zippable', 'evidence'],
    'A craft uses ui, jobs, project, view and shared; crafts do not know each other or the app.',
  ),
  closed(
    ['web/src/crafts/thermoform/**'],
    ['app', 'machines', 'crafts', 'relief', 'zippable', 'evidence'],
    'A craft uses ui, jobs, project, view and shared; crafts do not know each other or the app.',
  ),
  closed(
    ['web/src/crafts/evidence/**'],
    ['app', 'machines', 'crafts', 'relief', 'thermoform', 'zippable'],
    'A craft uses ui, jobs, project, view and shared; crafts do not know each other or the app.',
  ),
);
