// SPDX-License-Identifier: GPL-3.0-or-later
import type { ComponentChildren } from 'preact';
import { IconButton } from './button';
import type { IconName } from './icon';
import { Icon } from './icon';

export interface NoteProps {
  readonly kind: 'bad' | 'attention' | 'plain';
  readonly icon: IconName;
  readonly title: string;
  readonly children?: ComponentChildren;
  /** The mends, as buttons. */
  readonly actions?: ComponentChildren;
  readonly onDismiss?: () => void;
}

/** What happened, then the mend, at the foot of the viewport. */
export function Note({ kind, icon, title, children, actions, onDismiss }: NoteProps) {
  return (
    <section class={`note ${kind}`} role={kind === 'bad' ? 'alert' : 'status'}>
      <span class="note-icon">
        <Icon name={icon} small />
      </span>
      <div class="grow">
        <strong>{title}</strong>
        {children ? <p>{children}</p> : null}
        {actions ? <div class="row">{actions}</div> : null}
      </div>
      {onDismiss ? <IconButton icon="close" label="Hide this note" onClick={onDismiss} /> : null}
    </section>
  );
}
