// SPDX-License-Identifier: GPL-3.0-or-later
import { effect } from '@preact/signals';
import type { ProjectStore } from '../project/project_store';

/** The browser asks before it closes a page whose project could not be saved, until it is saved after all. */
export function askBeforeLeaving(
  { saveState }: Pick<ProjectStore, 'saveState'>,
  page: Pick<EventTarget, 'addEventListener' | 'removeEventListener'>,
): void {
  const ask = (event: Event) => event.preventDefault();
  effect(() => {
    // Between the two it is being tried again.
    const { state } = saveState.value;
    if (state === 'failed') page.addEventListener('beforeunload', ask);
    if (state === 'saved') page.removeEventListener('beforeunload', ask);
  });
}
