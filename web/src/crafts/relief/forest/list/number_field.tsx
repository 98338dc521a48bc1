// SPDX-License-Identifier: GPL-3.0-or-later
import { useId, useState } from 'preact/hooks';
import { parseNumber } from '../../../../ui';
import { placeNumber } from '../views';

export interface NumberFieldProps {
  readonly label: string;
  /** Left out where the label stands beside several fields. */
  readonly shown?: string;
  readonly unit: string;
  readonly value: number;
  readonly integer?: boolean;
  readonly onChange: (value: number) => void;
}

/** One number of the scene. What makes no sense in it the core says; what is no number is not taken. */
export function NumberField({ label, shown, unit, value, integer, onChange }: NumberFieldProps) {
  const id = useId();
  const [draft, setDraft] = useState<string | null>(null);
  const text = integer ? String(value) : placeNumber(value);
  const take = () => {
    const next = draft === null ? null : parseNumber(draft);
    setDraft(null);
    if (next !== null && next !== value) onChange(integer ? Math.round(next) : next);
  };
  return (
    <div class="scene-number">
      <label for={id}>
        {shown ?? label}
        {shown === undefined ? null : <span class="hidden-text">, {label}</span>}
      </label>
      <div class="number">
        <input
          id={id}
          type="text"
          inputMode={integer ? 'numeric' : 'decimal'}
          autocomplete="off"
          spellcheck={false}
          aria-label={label}
          value={draft ?? text}
          onFocus={(event) => event.currentTarget.select()}
          onInput={(event) => setDraft(event.currentTarget.value)}
          onBlur={take}
          onKeyDown={(event) => {
            if (event.key === 'Enter') take();
            else if (event.key === 'Escape' && draft !== null) {
              event.stopPropagation();
              setDraft(null);
            }
          }}
        />
        {unit ? <span aria-hidden="true">{unit}</span> : null}
      </div>
    </div>
  );
}
