// SPDX-License-Identifier: GPL-3.0-or-later
// The control of one parameter, made from its declaration in the catalog.
import { useId } from 'preact/hooks';
import type { Json, JsonObject } from '../../../jobs/contract';
import { Parameter, Segmented, Switch, tipHandlers } from '../../../ui';
import type { Entry } from './find_parameters';
import { defaultOf } from './find_parameters';
import { VectorField } from './vector_field';

export interface ParameterValues {
  /** Only what differs from the defaults. */
  readonly parameters: JsonObject;
  /** Sentences from the backend by parameter name. */
  readonly errors: Readonly<Record<string, string>>;
  readonly onPreview: (name: string, value: Json) => void;
  readonly onCommit: () => void;
  /** What automatic values came to. */
  readonly automatic?: Readonly<Record<string, number>>;
}

type ControlProps = ParameterValues & { readonly entry: Entry };

/** The control that fits the type of a parameter. */
export function ParameterControl({ entry, ...props }: ControlProps) {
  const [name, schema] = entry;
  const types = Array.isArray(schema.type) ? (schema.type as readonly string[]) : [schema.type as string];
  const fallback = defaultOf(entry);
  const value = props.parameters[name] ?? fallback;
  const label = schema.title ?? name;
  const help = schema.description;
  const error = props.errors[name];
  const set = (next: Json) => props.onPreview(name, next);
  const setAtOnce = (next: Json) => {
    set(next);
    props.onCommit();
  };
  if (schema.enum) {
    const labels = schema['x-choice-labels'] ?? schema.enum;
    const options = schema.enum.map((choice, i) => ({ value: choice, label: labels[i] ?? choice }));
    return <Choice {...{ label, help, options, error }} value={value as string} onChange={setAtOnce} />;
  }
  if (types.includes('boolean'))
    return <Switch {...{ label, help }} value={value === true} onChange={setAtOnce} />;
  if (types.includes('number') || types.includes('integer')) {
    const optional = types.includes('null');
    const automatic = props.automatic?.[name];
    return (
      <Parameter
        {...{ label, help, error, optional }}
        unit={schema['x-unit'] ?? ''}
        minimum={schema.minimum ?? -Infinity}
        maximum={schema.maximum ?? Infinity}
        automatic={automatic}
        slider={optional && automatic === undefined ? null : (schema['x-slider'] ?? null)}
        integer={types.includes('integer')}
        defaultValue={fallback as number | null}
        value={value as number | null}
        onPreview={set}
        onCommit={props.onCommit}
      />
    );
  }
  if (types.includes('array'))
    return (
      <VectorField {...{ label, help, error }} value={value as readonly number[]} onChange={setAtOnce} />
    );
  return null;
}

interface ChoiceProps {
  readonly label: string;
  readonly help: string | undefined;
  readonly error: string | undefined;
  readonly options: readonly { value: string; label: string }[];
  readonly value: string;
  readonly onChange: (value: string) => void;
}

/** Two or three short choices side by side, more as a menu. */
function Choice({ label, help, error, options, value, onChange }: ChoiceProps) {
  const id = useId();
  const letters = options.reduce((sum, option) => sum + option.label.length, 0);
  const segmented = options.length <= 3 && letters <= 22;
  return (
    <div class="field-line">
      {segmented ? (
        <span id={id} {...tipHandlers(help, 'left')}>
          {label}
        </span>
      ) : (
        <label for={id} {...tipHandlers(help, 'left')}>
          {label}
        </label>
      )}
      {segmented ? (
        <Segmented
          labelledBy={id}
          describedBy={`${id}-help`}
          options={options}
          value={value}
          onChange={onChange}
        />
      ) : (
        <select
          id={id}
          class="select"
          aria-describedby={`${id}-help`}
          value={value}
          onChange={(event) => onChange(event.currentTarget.value)}
        >
          {options.map((option) => (
            <option key={option.value} value={option.value}>
              {option.label}
            </option>
          ))}
        </select>
      )}
      <span id={`${id}-help`} class="hidden-text">
        {help}
      </span>
      {error ? (
        <span class="problem" role="alert">
          {error}
        </span>
      ) : null}
    </div>
  );
}
