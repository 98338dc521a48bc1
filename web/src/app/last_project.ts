// SPDX-License-Identifier: GPL-3.0-or-later
// Which project a tab opens: its own after a reload; a new tab the one that was worked on last, in any tab.
import type { ProjectStore } from '../project/project_store';

const key = 'formwright.project';

type Own = Pick<Storage, 'getItem' | 'setItem'>;

export const lastProject = (tab: Own, browser: Own): string | null =>
  tab.getItem(key) ?? browser.getItem(key);

export function rememberProject(
  { document, isBlank }: Pick<ProjectStore, 'document' | 'isBlank'>,
  tab: Own,
  browser: Own,
): void {
  document.subscribe(({ id }) => {
    try {
      tab.setItem(key, id);
      // A second tab begins with an empty project; that is not what was worked on last.
      if (!isBlank.peek()) browser.setItem(key, id);
    } catch {
      // The project is still in the list.
    }
  });
}
