// SPDX-License-Identifier: GPL-3.0-or-later
import type { IconName } from './icon';
import { Icon } from './icon';
import { tipHandlers } from './tip';

interface SegmentedOption<T extends string> {
  readonly value: T;
  readonly label: string;
  readonly icon?: IconName;
  readonly disabledReason?: string | undefined;
}

export interface SegmentedProps<T extends string> {
  /** Spoken name of the group, or the id of the element that names it. */
  readonly label?: string;
  readonly labelledBy?: string;
  readonly describedBy?: string | undefined;
  readonly options: readonly SegmentedOption<T>[];
  readonly value: T;
  readonly onChange: (value: T) => void;
  readonly floating?: boolean;
}

/** Two to four exclusive views or values: one tab stop, arrows move. */
export function Segmented<T extends string>(props: SegmentedProps<T>) {
  const { options, value, onChange } = props;
  const move = (event: KeyboardEvent) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (step === undefined) return;
    event.preventDefault();
    const enabled = options.filter((option) => !option.disabledReason);
    const at = enabled.findIndex((option) => option.value === value);
    const next = enabled[(at + step + enabled.length) % enabled.length];
    if (next === undefined) return;
    onChange(next.value);
    const buttons = (event.currentTarget as Element).querySelectorAll<HTMLElement>('button');
    buttons[options.indexOf(next)]?.focus();
  };
  return (
    <div
      role="radiogroup"
      class={props.floating ? 'segmented floating' : 'segmented'}
      aria-label={props.label}
      aria-labelledby={props.labelledBy}
      aria-describedby={props.describedBy}
      onKeyDown={move}
    >
      {options.map((option) => (
        <button
          key={option.value}
          type="button"
          role="radio"
          aria-checked={option.value === value}
          aria-disabled={option.disabledReason ? true : undefined}
          tabIndex={option.value === value ? 0 : -1}
          onClick={() => {
            if (!option.disabledReason) onChange(option.value);
          }}
          {...tipHandlers(option.disabledReason)}
        >
          {option.icon ? <Icon name={option.icon} small /> : null}
          {option.label}
        </button>
      ))}
    </div>
  );
}
