// SPDX-License-Identifier: GPL-3.0-or-later
import { useId, useState } from 'preact/hooks';
import { formatNumber, parseNumber, tipHandlers } from '../../../ui';

export interface VectorFieldProps {
  readonly label: string;
  readonly help?: string | undefined;
  readonly error?: string | undefined;
  readonly value: readonly number[];
  readonly onChange: (value: number[]) => void;
}

const axes = ['x', 'y', 'z'];

/** Three numbers. */
export function VectorField({ label, help, error, value, onChange }: VectorFieldProps) {
  const id = useId();
  const [draft, setDraft] = useState<{ axis: number; text: string } | null>(null);
  const take = () => {
    if (draft === null) return;
    const number = parseNumber(draft.text);
    setDraft(null);
    if (number === null) return;
    const next = value.map((old, axis) => (axis === draft.axis ? number : old));
    if (next[draft.axis] !== value[draft.axis]) onChange(next);
  };
  return (
    <div class="parameter" role="group" aria-labelledby={id} aria-describedby={`${id}-help`}>
      <div class="parameter-label" {...tipHandlers(help, 'left')}>
        <span id={id}>{label}</span>
        {error ? (
          <span class="problem" role="alert">
            {error}
          </span>
        ) : null}
      </div>
      <div class="vector">
        {axes.map((name, axis) => (
          <div key={name} class={error ? 'number bad' : 'number'}>
            <input
              type="text"
              inputMode="decimal"
              aria-label={`${label} ${name}`}
              value={draft?.axis === axis ? draft.text : formatNumber(value[axis] ?? 0, 3)}
              onInput={(event) => setDraft({ axis, text: event.currentTarget.value })}
              onBlur={take}
              onKeyDown={(event) => {
                if (event.key === 'Enter') take();
                else if (event.key === 'Escape' && draft) {
                  event.stopPropagation();
                  setDraft(null);
                }
              }}
            />
          </div>
        ))}
      </div>
      <span id={`${id}-help`} class="hidden-text">
        {help}
      </span>
    </div>
  );
}
