// SPDX-License-Identifier: GPL-3.0-or-later
// Whether the page shows that a step was done.
import { parseNumber } from '../../ui';
import { findControl } from './find_control';
import type { Sign, Step } from './tutorial';

/** What was seen of the step since it began, and leaves no trace in the page. */
export interface Seen {
  readonly pressed: boolean;
  readonly said: boolean;
  /** Enter was pressed in its field, or the field was left. */
  readonly entered: boolean;
}

const isDisabled = (element: Element): boolean => element.getAttribute('aria-disabled') === 'true';

function hasValue(control: HTMLElement | null, wanted: string, seen: Seen): boolean {
  if (control instanceof HTMLSelectElement)
    return control.options[control.selectedIndex]?.textContent === wanted;
  if (!(control instanceof HTMLInputElement)) return false;
  // Half a number, while it is being typed, is none yet.
  if (document.activeElement === control && !seen.entered) return false;
  return parseNumber(control.value) === parseNumber(wanted);
}

function holds(sign: Sign, step: Step, seen: Seen): boolean {
  if ('pressed' in sign) return seen.pressed;
  if ('said' in sign) return seen.said;
  if ('value' in sign) return hasValue(step.control && findControl(step.control), sign.value, seen);
  if ('shown' in sign) return findControl(sign.shown) !== null;
  if ('gone' in sign) return findControl(sign.gone) === null;
  if ('enabled' in sign) {
    const control = findControl(sign.enabled);
    return control !== null && !isDisabled(control);
  }
  const titles = [...document.querySelectorAll('footer strong')];
  return titles.some(({ textContent }) => textContent?.startsWith(sign.strip) === true);
}

export const stepDone = (step: Step, seen: Seen): boolean =>
  step.done.every((sign) => holds(sign, step, seen));
