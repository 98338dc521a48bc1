// SPDX-License-Identifier: GPL-3.0-or-later
import type { IconName } from './icon_paths';
import { iconPaths } from './icon_paths';

export type { IconName };

export function Icon({ name, small }: { name: IconName; small?: boolean }) {
  const markup = { __html: iconPaths[name] };
  return (
    <svg
      class={small ? 'icon small' : 'icon'}
      viewBox="0 0 24 24"
      aria-hidden="true"
      dangerouslySetInnerHTML={markup}
    />
  );
}
