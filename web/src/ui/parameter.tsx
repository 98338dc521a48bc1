// SPDX-License-Identifier: GPL-3.0-or-later
// A number a maker sets: label above, slider left, number with its unit right. Range, default, unit and
// help are the operation's; nothing of them is known here.
import { useId, useRef, useState } from 'preact/hooks';
import { decimalsOf, formatOnStep, niceStep, parseNumber, roundTo, withUnit } from './numbers';
import { tipHandlers } from './tip';

export interface ParameterProps {
  readonly label: string;
  readonly help?: string | undefined;
  readonly unit: string;
  readonly minimum: number;
  readonly maximum: number;
  /** The useful part of the range; null for a number without a slider. */
  readonly slider: readonly [number, number] | null;
  readonly integer?: boolean;
  /** null: the value may be left out. */
  readonly defaultValue: number | null;
  readonly optional?: boolean;
  /** What an automatic value came to, where it is known: the slider begins there. */
  readonly automatic?: number | undefined;
  readonly value: number | null;
  /** A sentence from the backend about this value. */
  readonly error?: string | undefined;
  /** While a slider is dragged; `onCommit` follows. */
  readonly onPreview: (value: number | null) => void;
  /** The step for undo ends here. */
  readonly onCommit: () => void;
}

export function Parameter(props: ParameterProps) {
  const { label, unit, minimum, maximum, slider, value, onPreview, onCommit } = props;
  const id = useId();
  const step = stepOf(props);
  const format = (number: number) => (props.integer ? String(number) : formatOnStep(number, step));
  const [draft, setDraft] = useState<string | null>(null);
  const [problem, setProblem] = useState<string | null>(null);
  const field = useRef<HTMLInputElement>(null);
  const range = `${format(minimum)} to ${withUnit(format(maximum), unit)}`;
  const fallback = props.defaultValue === null ? 'automatic' : format(props.defaultValue);
  const tip = [
    props.help,
    `Range ${range}. Default ${fallback === 'automatic' ? fallback : withUnit(fallback, unit)}.`,
  ]
    .filter(Boolean)
    .join(' ');
  const changed = value !== props.defaultValue;
  const shownValue = value ?? props.defaultValue ?? props.automatic ?? null;
  const message = problem ?? props.error ?? null;

  const set = (next: number | null) => {
    setProblem(null);
    setDraft(null);
    onPreview(next);
  };
  const stepBy = (share: number, base: readonly [number, number]) => {
    const start = shownValue ?? base[0];
    const width = base[1] - base[0];
    const grid = props.integer ? 1 : Math.min(step, niceStep(base[0], base[1]));
    const by = Math.max(grid, Math.abs(roundTo(share * width, grid))) * Math.sign(share);
    set(clamp(roundTo(start + by, grid), minimum, maximum));
    onCommit();
  };
  const arrows = (event: KeyboardEvent, base: readonly [number, number]) => {
    const directions: Record<string, number> = { ArrowUp: 1, ArrowDown: -1, ArrowRight: 1, ArrowLeft: -1 };
    const direction = directions[event.key];
    const inField = event.currentTarget === field.current;
    if (direction === undefined || (inField && event.key.length > 9)) return false;
    if (inField && (event.key === 'ArrowLeft' || event.key === 'ArrowRight')) return false;
    event.preventDefault();
    stepBy((event.shiftKey ? 0.1 : 0.01) * direction, base);
    return true;
  };
  const take = () => {
    if (draft === null) return;
    const text = draft.trim();
    if (text === '' && props.optional) {
      set(null);
      onCommit();
      return;
    }
    const next = parseNumber(text);
    if (next === null || next < minimum || next > maximum || (props.integer && !Number.isInteger(next)))
      setProblem(props.integer ? `A whole number, ${range}` : range); // the last good value stays in force
    else {
      set(next);
      onCommit();
    }
  };
  const restore = () => {
    set(props.defaultValue);
    onCommit();
  };
  const base = slider ?? ([minimum, Math.min(maximum, 100 * Math.max(1, Math.abs(minimum)))] as const);

  return (
    <div class="parameter">
      <div class="parameter-label" onDblClick={restore} {...tipHandlers(tip, 'left')}>
        <label for={`${id}-number`}>{label}</label>
        {message !== null ? (
          <span id={`${id}-error`} class="problem" role="alert">
            {message}
          </span>
        ) : changed ? (
          <button
            type="button"
            class="was"
            onClick={(event) => {
              restore();
              if (event.detail === 0) field.current?.focus(); // this button goes away: the keyboard goes on from the number
            }}
            aria-label={`Restore ${label} to ${fallback}`}
          >
            {fallback === 'automatic' ? 'automatic' : `default ${fallback}`}
          </button>
        ) : null}
      </div>
      {slider ? (
        <input
          type="range"
          aria-label={label}
          aria-describedby={`${id}-help`}
          aria-valuetext={value === null ? 'automatic' : withUnit(format(value), unit)}
          min={slider[0]}
          max={slider[1]}
          step="any"
          value={clamp(shownValue ?? slider[0], slider[0], slider[1])}
          style={{
            '--filled': `${(100 * (clamp(shownValue ?? slider[0], ...slider) - slider[0])) / (slider[1] - slider[0])}%`,
          }}
          onInput={(event) => {
            const next = roundTo(Number(event.currentTarget.value), props.integer ? 1 : step);
            set(clamp(next, minimum, maximum));
          }}
          onChange={onCommit}
          onDblClick={restore}
          onKeyDown={(event) => {
            if (event.key === 'Home' || event.key === 'End') {
              event.preventDefault();
              set(slider[event.key === 'Home' ? 0 : 1]);
              onCommit();
            } else arrows(event, slider);
          }}
        />
      ) : null}
      <div class={message !== null ? 'number bad' : 'number'}>
        <input
          ref={field}
          id={`${id}-number`}
          type="text"
          inputMode={props.integer ? 'numeric' : 'decimal'}
          autocomplete="off"
          spellcheck={false}
          placeholder={props.optional ? 'Automatic' : ''}
          value={draft ?? (value === null ? '' : format(value))}
          aria-invalid={message !== null || undefined}
          aria-describedby={message !== null ? `${id}-error ${id}-help` : `${id}-help`}
          onInput={(event) => setDraft(event.currentTarget.value)}
          onBlur={take}
          onFocus={(event) => event.currentTarget.select()}
          onKeyDown={(event) => {
            if (event.key === 'Enter') {
              if (!event.ctrlKey && !event.metaKey) event.preventDefault();
              take();
            } else if (event.key === 'Escape' && (draft !== null || problem !== null)) {
              event.stopPropagation();
              setDraft(null);
              setProblem(null);
            } else arrows(event, base);
          }}
        />
        {unit && value !== null ? <span aria-hidden="true">{unit}</span> : null}
      </div>
      <span id={`${id}-help`} class="hidden-text">
        {unit ? `In ${unit}. ` : ''}
        {tip}
      </span>
    </div>
  );
}

const clamp = (value: number, low: number, high: number) => Math.min(high, Math.max(low, value));

function stepOf({ slider, minimum, maximum, integer, defaultValue }: ParameterProps): number {
  if (integer) return 1;
  if (slider) return niceStep(slider[0], slider[1]);
  const scale = Math.abs(defaultValue ?? 0) || Math.min(maximum - minimum, 100);
  return 10 ** -Math.min(4, decimalsOf(scale / 100));
}
