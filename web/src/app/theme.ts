// SPDX-License-Identifier: GPL-3.0-or-later
import { signal } from '@preact/signals';

export type Theme = 'light' | 'dark';

const key = 'formwright.theme';
const current = (): Theme => (document.documentElement.dataset['theme'] === 'dark' ? 'dark' : 'light');

export const theme = signal<Theme>(current());

function show(next: Theme): void {
  document.documentElement.dataset['theme'] = next;
  document
    .querySelector('meta[name=theme-color]')
    ?.setAttribute('content', next === 'dark' ? '#201e1c' : '#fbfaf7');
  theme.value = next;
}

export function chooseTheme(next: Theme): void {
  try {
    localStorage.setItem(key, next);
  } catch {
    // Then it holds for this visit only.
  }
  show(next);
}

/** Follows the system until the maker has chosen. */
export function followSystemTheme(): void {
  show(current());
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', ({ matches }) => {
    if (localStorage.getItem(key) === null) show(matches ? 'dark' : 'light');
  });
}
