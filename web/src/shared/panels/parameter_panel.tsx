// SPDX-License-Identifier: GPL-3.0-or-later
// The controls of an operation, made from its declaration in the catalog.
import type { ComponentChildren } from 'preact';
import { useId, useState } from 'preact/hooks';
import type { Json, JsonObject, Operation, ParameterSchema } from '../../jobs/contract';
import { Icon, Parameter, Segmented, Switch, tipHandlers } from '../../ui';
import { PresetChoice } from './preset_choice';
import { VectorField } from './vector_field';

export interface ParameterPanelProps {
  readonly operation: Operation;
  /** Only what differs from the defaults. */
  readonly parameters: JsonObject;
  /** Sentences from the backend by parameter name. */
  readonly errors: Readonly<Record<string, string>>;
  readonly onPreview: (name: string, value: Json) => void;
  readonly onCommit: () => void;
  /** Put in front of a group's parameters, also where that is folded. */
  readonly groupHead?: Readonly<Record<string, ComponentChildren>>;
  /** Takes the values of a preset; left out: no presets are offered. */
  readonly onPreset?: (values: JsonObject, label: string) => void;
  /** What automatic values came to. */
  readonly automatic?: Readonly<Record<string, number>>;
  /** Groups that stand open; left out: all. The others are folded, as the advanced parameters are. */
  readonly openGroups?: readonly string[];
}

type Entry = readonly [name: string, schema: ParameterSchema];

export function ParameterPanel(props: ParameterPanelProps) {
  const entries = Object.entries(props.operation.parameters.properties);
  const plain = entries.filter(([, schema]) => !schema['x-advanced']);
  const advanced = entries.filter(([, schema]) => schema['x-advanced']);
  const groups = new Map<string, Entry[]>(Object.keys(props.groupHead ?? {}).map((title) => [title, []]));
  for (const entry of plain) {
    const title = entry[1]['x-group'] ?? '';
    groups.set(title, [...(groups.get(title) ?? []), entry]);
  }
  const isOpen = ([title]: readonly [string, unknown]) => props.openGroups?.includes(title) ?? true;
  const folded: [string, Entry[]][] = [
    ...[...groups].filter((group) => !isOpen(group)),
    ['Advanced', advanced],
  ];
  return (
    <>
      {[...groups].filter(isOpen).map(([title, members]) => (
        <section key={title} class="section" aria-label={title || 'Parameters'}>
          {title ? <h3>{title}</h3> : null}
          {props.groupHead?.[title]}
          <Presets group={title} panel={props} />
          {members.map((entry) => (
            <Control key={entry[0]} entry={entry} {...props} />
          ))}
        </section>
      ))}
      {folded.map(([title, members]) =>
        members.length > 0 ? <Folded key={title} title={title} members={members} panel={props} /> : null,
      )}
    </>
  );
}

function Presets({ group, panel }: { readonly group: string; readonly panel: ParameterPanelProps }) {
  const { operation, parameters, onPreset } = panel;
  if (!onPreset) return null;
  return (
    <>
      {(operation.presets ?? [])
        .filter((list) => list.group === group)
        .map((list) => (
          <PresetChoice key={list.name} {...{ list, operation, parameters }} onChoose={onPreset} />
        ))}
    </>
  );
}

interface FoldedProps {
  readonly title: string;
  readonly members: readonly Entry[];
  readonly panel: ParameterPanelProps;
}

/** Opens by itself where one of its values is wrong. */
function Folded({ title, members, panel }: FoldedProps) {
  const [chosen, setOpen] = useState(false);
  const id = useId();
  const open = chosen || members.some(([name]) => panel.errors[name] !== undefined);
  return (
    <>
      <button
        type="button"
        class="fold"
        aria-expanded={open}
        aria-controls={id}
        onClick={() => setOpen(!open)}
      >
        <Icon name={open ? 'chevronDown' : 'chevronRight'} small />
        {title}
        <span>{members.length}</span>
      </button>
      <section id={id} class="section" hidden={!open} aria-label={title}>
        {open ? panel.groupHead?.[title] : null}
        {open ? <Presets group={title} panel={panel} /> : null}
        {open ? members.map((entry) => <Control key={entry[0]} entry={entry} {...panel} />) : null}
      </section>
    </>
  );
}

function Control({ entry: [name, schema], ...props }: ParameterPanelProps & { entry: Entry }) {
  const types = Array.isArray(schema.type) ? (schema.type as readonly string[]) : [schema.type as string];
  const fallback = schema.default ?? null;
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
