// SPDX-License-Identifier: GPL-3.0-or-later
// Finds a control of the page as a person or a screen reader does: by its kind and its name.
import type { Control } from './tutorial';

const selectors: Readonly<Record<Control['role'], string>> = {
  button: 'button:not([role]), [role=button]',
  link: 'a[href]',
  radio: '[role=radio], input[type=radio]',
  switch: '[role=switch]',
  textbox: 'input[type=text], textarea',
  slider: 'input[type=range], [role=slider]',
  combobox: 'select',
  menuitem: '[role=menuitem]',
  application: '[role=application]',
  img: 'img, [role=img]',
};

const tidy = (text: string): string => text.replaceAll(/[\s\u2009\u202f]+/g, ' ').trim();

/** Text without what is only a picture. */
function wordsIn(element: Element): string {
  const copy = element.cloneNode(true) as Element;
  for (const hidden of copy.querySelectorAll('[aria-hidden=true], svg')) hidden.remove();
  return copy.textContent ?? '';
}

export function nameOf(element: Element): string {
  const label = element.getAttribute('aria-label');
  if (label !== null) return tidy(label);
  const labelledBy = element.getAttribute('aria-labelledby');
  if (labelledBy !== null) return tidy(document.getElementById(labelledBy)?.textContent ?? '');
  if (element.matches('input, select, textarea'))
    return tidy([...((element as HTMLInputElement).labels ?? [])].map(wordsIn).join(' '));
  if (element.matches('img')) return tidy(element.getAttribute('alt') ?? '');
  return tidy(wordsIn(element));
}

const isShown = (element: Element): boolean => element.checkVisibility({ visibilityProperty: true });

/** Where one can act: in the question that stands before the page, else everywhere but in the tutorial's own card. */
function scope(): Element {
  const dialogs = document.querySelectorAll('dialog[open]');
  return dialogs[dialogs.length - 1] ?? document.body;
}

/** The first that is shown: its whole name, else a name that begins so. */
export function findControl({ role, name, exact }: Control): HTMLElement | null {
  const all = [...scope().querySelectorAll<HTMLElement>(selectors[role])].filter(
    (element) => element.closest('.learn') === null,
  );
  const named = (fits: (found: string) => boolean) =>
    all.find((element) => fits(nameOf(element)) && isShown(element));
  return (
    named((found) => found === name) ?? (exact ? undefined : named((found) => found.startsWith(name))) ?? null
  );
}
