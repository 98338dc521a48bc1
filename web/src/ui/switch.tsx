// SPDX-License-Identifier: GPL-3.0-or-later
import { useId } from 'preact/hooks';
import { tipHandlers } from './tip';

export interface SwitchProps {
  readonly label: string;
  readonly help?: string | undefined;
  readonly value: boolean;
  readonly onChange: (value: boolean) => void;
}

/** For what acts at once. */
export function Switch({ label, help, value, onChange }: SwitchProps) {
  const helpId = useId();
  return (
    <>
      <button
        type="button"
        role="switch"
        class="switch"
        aria-checked={value}
        aria-describedby={help ? helpId : undefined}
        onClick={() => onChange(!value)}
        {...tipHandlers(help, 'left')}
      >
        {label}
      </button>
      {help ? (
        <span id={helpId} class="hidden-text">
          {help}
        </span>
      ) : null}
    </>
  );
}
