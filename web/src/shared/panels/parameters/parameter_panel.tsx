// SPDX-License-Identifier: GPL-3.0-or-later
// The controls of an operation, made from its declaration in the catalog.
import type { ComponentChildren } from 'preact';
import { useId, useState } from 'preact/hooks';
import type { JsonObject, Operation, PresetList } from '../../../jobs/contract';
import { Icon } from '../../../ui';
import type { Entry } from './find_parameters';
import { counts, groupOf, hasControl, isChanged } from './find_parameters';
import { FoundParameters, ParameterSearch, useParameterSearch } from './parameter_search';
import type { ParameterValues } from './parameter_control';
import { ParameterControl } from './parameter_control';
import { PresetChoice } from './preset_choice';

export interface ParameterPanelProps extends ParameterValues {
  readonly operation: Operation;
  /** Put in front of a group's parameters, also where that is folded. */
  readonly groupHead?: Readonly<Record<string, ComponentChildren>>;
  /** Takes the values of a preset; left out: no presets are offered. */
  readonly onPreset?: (values: JsonObject, label: string) => void;
  /** Groups that stand open; left out: all. The others are folded, as the advanced parameters are. */
  readonly openGroups?: readonly string[];
}

/** That many are surveyed without a search. */
const maxWithoutSearch = 13;

export function ParameterPanel(props: ParameterPanelProps) {
  const entries = Object.entries(props.operation.parameters.properties).filter(hasControl);
  const presets = props.onPreset ? (props.operation.presets ?? []) : [];
  const search = useParameterSearch(entries, presets, props);
  if (entries.length <= maxWithoutSearch) return <Groups {...props} entries={entries} />;
  return (
    <>
      <ParameterSearch search={search} />
      {search.found ? (
        <>
          {search.foundPresets.length > 0 ? (
            <section class="section" aria-label="Presets">
              <Presets lists={search.foundPresets} panel={props} />
            </section>
          ) : null}
          <FoundParameters found={search.found} values={props} />
        </>
      ) : (
        <Groups {...props} entries={entries} />
      )}
    </>
  );
}

function Groups({ entries: all, ...props }: ParameterPanelProps & { readonly entries: readonly Entry[] }) {
  const entries = all.filter(
    (entry) => counts(entry, props.parameters, all) || props.errors[entry[0]] !== undefined,
  );
  const plain = entries.filter(([, schema]) => !schema['x-advanced']);
  const advanced = entries.filter(([, schema]) => schema['x-advanced']);
  const groups = new Map<string, Entry[]>(Object.keys(props.groupHead ?? {}).map((title) => [title, []]));
  for (const entry of plain) {
    const title = groupOf(entry);
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
          <Presets lists={presetsOf(props, title)} panel={props} />
          {members.map((entry) => (
            <ParameterControl key={entry[0]} entry={entry} {...props} />
          ))}
        </section>
      ))}
      {folded.map(([title, members]) =>
        members.length > 0 ? <Folded key={title} title={title} members={members} panel={props} /> : null,
      )}
    </>
  );
}

const presetsOf = ({ operation }: ParameterPanelProps, group: string): readonly PresetList[] =>
  (operation.presets ?? []).filter((list) => list.group === group);

interface PresetsProps {
  readonly lists: readonly PresetList[];
  readonly panel: ParameterPanelProps;
}

function Presets({ lists, panel: { operation, parameters, onPreset } }: PresetsProps) {
  if (!onPreset) return null;
  return (
    <>
      {lists.map((list) => (
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
  const changed = members.filter((entry) => isChanged(panel.parameters, entry)).length;
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
        <span>{changed > 0 ? `${changed} of ${members.length} changed` : members.length}</span>
      </button>
      <section id={id} class="section" hidden={!open} aria-label={title}>
        {open ? (
          <>
            {panel.groupHead?.[title]}
            <Presets lists={presetsOf(panel, title)} panel={panel} />
            {members.map((entry) => (
              <ParameterControl key={entry[0]} entry={entry} {...panel} />
            ))}
          </>
        ) : null}
      </section>
    </>
  );
}
