// SPDX-License-Identifier: GPL-3.0-or-later
import type { ComponentChildren, Ref } from 'preact';
import { useId } from 'preact/hooks';
import type { IconName } from './icon';
import { Icon } from './icon';
import { tipHandlers } from './tip';

export interface ButtonProps {
  readonly children?: ComponentChildren;
  readonly onClick?: (event: MouseEvent) => void;
  /** One filled button per screen. */
  readonly kind?: 'outlined' | 'filled' | 'quiet' | 'danger';
  readonly size?: 'small' | 'normal' | 'big';
  readonly icon?: IconName;
  /** Why it cannot be pressed now; it keeps its place and its focus. */
  readonly disabledReason?: string | undefined;
  readonly title?: string | undefined;
  readonly class?: string;
  readonly buttonRef?: Ref<HTMLButtonElement>;
  readonly type?: 'button' | 'submit';
}

export function Button(props: ButtonProps) {
  const { kind = 'outlined', size = 'normal', disabledReason } = props;
  const reasonId = useId();
  const disabled = disabledReason !== undefined;
  return (
    <button
      ref={props.buttonRef ?? null}
      type={props.type ?? 'button'}
      class={`button ${kind} ${size} ${props.class ?? ''}`}
      aria-disabled={disabled || undefined}
      aria-describedby={disabledReason ? reasonId : undefined}
      onClick={(event) => (disabled ? event.preventDefault() : props.onClick?.(event))}
      {...tipHandlers(disabledReason ?? props.title)}
    >
      {props.icon ? <Icon name={props.icon} /> : null}
      {props.children}
      {disabledReason ? (
        <span id={reasonId} class="hidden-text">
          {disabledReason}
        </span>
      ) : null}
    </button>
  );
}

export interface IconButtonProps {
  readonly icon: IconName;
  readonly label: string;
  readonly onClick: (event: MouseEvent) => void;
  readonly disabled?: boolean;
  readonly class?: string;
  readonly pressed?: boolean;
  readonly keys?: string;
}

/** A button that is only a picture; its label is its tip. */
export function IconButton({ icon, label, onClick, disabled, pressed, keys, ...rest }: IconButtonProps) {
  return (
    <button
      type="button"
      class={`icon-button ${rest.class ?? ''}`}
      aria-label={label}
      aria-disabled={disabled || undefined}
      aria-pressed={pressed}
      aria-keyshortcuts={keys}
      onClick={(event) => {
        if (!disabled) onClick(event);
      }}
      {...tipHandlers(keys ? `${label} (${keys.replaceAll('+', ' + ').replace('Control', 'Ctrl')})` : label)}
    >
      <Icon name={icon} />
    </button>
  );
}
