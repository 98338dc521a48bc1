// SPDX-License-Identifier: GPL-3.0-or-later
import { effect } from '@preact/signals';
import type { ProjectStore } from '../project/project_store';

/** The browser asks before it closes a page whose project could not be saved, until it is saved after all; where nothing lasts
 *  beyond the page, as soon as there is something to lose. */
export function askBeforeLeaving(
  { saveState, isBlank, lasts }: Pick<ProjectStore, 'saveState' | 'isBlank' | 'lasts'>,
  page: Pick<EventTarget, 'addEventListener' | 'removeEventListener'>,
): void {
  const ask = (event: Event) => event.preventDefault();
  effect(() => {
    // Between the two it is being tried again.
    const { state } = saveState.value;
    const passing = !lasts && !isBlank.value;
    if (state === 'failed' || passing) page.addEventListener('beforeunload', ask);
    else if (state === 'saved') page.removeEventListener('beforeunload', ask);
  });
}
