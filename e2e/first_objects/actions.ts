// SPDX-License-Identifier: GPL-3.0-or-later
// Counts what a person does, from the events that the page receives: what a story calls does not matter.
//
// One action each: a press or a tap, a drag, a key outside text fields, a text typed into a field with its Enter, a choice in a list,
// files chosen or dropped together. Looking, scrolling and moving the pointer are none. Events made by a script count as well.
import type { Page } from '@playwright/test';

interface Action {
  readonly kind: 'press' | 'drag' | 'key' | 'text' | 'choice' | 'files';
  /** What it was done to, in the page's words. */
  readonly what: string;
}

export interface ActionCount {
  /** Begins anew, with the time. */
  begin(): Promise<void>;
  /** What was done since, and the seconds that have passed. */
  end(): Promise<{ readonly actions: readonly Action[]; readonly seconds: number }>;
}

const binding = 'formwrightAction';
const barrier = 'formwrightAllReported';

/** To be called before the page is opened. */
export async function countActions(page: Page): Promise<ActionCount> {
  let actions: Action[] = [];
  let start_ms = Date.now();
  await page.exposeBinding(binding, (_, kind: Action['kind'], what: string, goesOn: boolean) => {
    const last = actions.at(-1);
    if (goesOn && last) actions[actions.length - 1] = { kind, what };
    else actions.push({ kind, what });
  });
  await page.exposeBinding(barrier, () => undefined);
  await page.addInitScript(watchActions, binding);
  // Reports come in their order, but after the browser's answer to what made them: this one comes after all of them.
  const allReported = () =>
    page.evaluate((name) => (window as unknown as Record<string, () => Promise<void>>)[name]?.(), barrier);
  return {
    begin: async () => {
      await allReported();
      actions = [];
      start_ms = Date.now();
    },
    end: async () => {
      const seconds = (Date.now() - start_ms) / 1000;
      await allReported();
      return { actions, seconds };
    },
  };
}

/** Runs in the page, before anything of its own: it uses nothing from outside. */
function watchActions(binding: string): void {
  type Report = (kind: string, what: string, goesOn: boolean) => void;
  const report = (kind: string, what: string, goesOn = false) =>
    (window as unknown as Record<string, Report>)[binding]?.(kind, what, goesOn);
  const drag_px = 6;
  const textTypes = ['text', 'search', 'number', 'email', 'password', 'tel', 'url'];
  const isText = (target: EventTarget | null): target is HTMLElement =>
    target instanceof HTMLTextAreaElement ||
    (target instanceof HTMLInputElement && textTypes.includes(target.type)) ||
    (target instanceof HTMLElement && target.isContentEditable);
  const nameOf = (target: EventTarget | null): string => {
    if (!(target instanceof Element)) return 'page';
    const control = target.closest(
      'button, a, label, input, select, textarea, summary, [role], [aria-label]',
    );
    const label = control instanceof HTMLInputElement ? control.labels?.[0] : undefined;
    const text =
      control?.getAttribute('aria-label') ??
      label?.textContent ??
      control?.querySelector('strong')?.textContent ??
      control?.textContent;
    return (text ?? '').trim().split(/[\n:]/)[0]?.slice(0, 60) || target.tagName.toLowerCase();
  };

  let from: { readonly x: number; readonly y: number } | null = null;
  let pressed: EventTarget | null = null;
  let pointed_ms = -Infinity;
  let tabbed_ms = -Infinity;
  addEventListener(
    'pointerdown',
    (event) => {
      if (!event.isPrimary && event.isTrusted) return; // the second finger of a gesture
      from = { x: event.clientX, y: event.clientY };
      pressed = event.target;
      pointed_ms = event.timeStamp;
      report('press', nameOf(event.target));
    },
    true,
  );
  addEventListener(
    'pointerup',
    (event) => {
      const moved = from && Math.hypot(event.clientX - from.x, event.clientY - from.y);
      from = null;
      if (moved !== null && moved > drag_px) report('drag', nameOf(pressed), true);
    },
    true,
  );
  // A click that no pointer and no key has made: a script's. The page itself asks so for files and hands out downloads.
  addEventListener(
    'click',
    (event) => {
      const { target } = event;
      const own =
        (target instanceof HTMLInputElement && target.type === 'file') ||
        (target instanceof HTMLAnchorElement && target.download !== '');
      if (!event.isTrusted && !own) report('press', nameOf(target));
    },
    true,
  );

  let typing: EventTarget | null = null;
  let reached: EventTarget | null = null;
  addEventListener(
    'focusin',
    (event) => {
      const byPointer =
        pressed instanceof Node && event.target instanceof HTMLInputElement
          ? pressed === event.target ||
            [...(event.target.labels ?? [])].some((label) => label.contains(pressed as Node))
          : pressed === event.target;
      const now_ms = event.timeStamp;
      reached = (byPointer && now_ms - pointed_ms < 1000) || now_ms - tabbed_ms < 200 ? event.target : null;
    },
    true,
  );
  addEventListener('focusout', () => (typing = null), true);
  const type = (field: HTMLElement) => {
    if (typing === field) return;
    typing = field;
    // A person first has to bring the focus there.
    if (reached !== field && pressed !== field) report('press', nameOf(field));
    report('text', nameOf(field));
  };
  addEventListener('input', (event) => (isText(event.target) ? type(event.target) : undefined), true);
  addEventListener(
    'keydown',
    (event) => {
      if (event.repeat || ['Control', 'Shift', 'Alt', 'Meta', 'AltGraph'].includes(event.key)) return;
      const { target, key } = event;
      const control = event.ctrlKey || event.metaKey;
      const leaves = key === 'Tab' || key === 'Escape';
      if (isText(target) && !leaves && (!control || 'acvxyz'.includes(key.toLowerCase()))) {
        type(target);
        if (key === 'Enter') typing = null;
        return;
      }
      if (target instanceof HTMLSelectElement && !leaves && !control) return; // its choice is counted
      if (key === 'Tab') tabbed_ms = event.timeStamp;
      const held = [
        control ? 'Ctrl' : '',
        event.altKey ? 'Alt' : '',
        event.shiftKey && key.length > 1 ? 'Shift' : '',
      ];
      report('key', [...held.filter(Boolean), key === ' ' ? 'Space' : key].join('+'));
    },
    true,
  );

  addEventListener(
    'change',
    ({ target }) => {
      if (target instanceof HTMLSelectElement)
        report('choice', target.selectedOptions[0]?.textContent ?? nameOf(target));
      else if (target instanceof HTMLInputElement && target.type === 'file' && target.files?.length)
        report('files', [...target.files].map(({ name }) => name).join(', '));
    },
    true,
  );
  addEventListener(
    'drop',
    ({ dataTransfer }) => {
      const names = [...(dataTransfer?.files ?? [])].map(({ name }) => name);
      if (names.length > 0) report('files', names.join(', '));
    },
    true,
  );
}
