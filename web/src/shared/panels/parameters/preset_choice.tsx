// SPDX-License-Identifier: GPL-3.0-or-later
// Values that belong together, chosen by a name that people know: a plastic, a vacuum former, a cloth.
import { useId } from 'preact/hooks';
import type { JsonObject, Operation, PresetList } from '../../../jobs/contract';
import { jsonEqual } from '../../../project/document';
import { inForce } from '../../session/craft_document';
import { tipHandlers } from '../../../ui';

export interface PresetChoiceProps {
  readonly list: PresetList;
  readonly operation: Operation;
  /** Only what differs from the defaults. */
  readonly parameters: JsonObject;
  readonly onChoose: (values: JsonObject, label: string) => void;
}

/** Names the preset whose values are all in force; its values stay open to change. */
export function PresetChoice({ list, operation, parameters, onChoose }: PresetChoiceProps) {
  const id = useId();
  const chosen = list.presets.find((preset) =>
    Object.entries(preset.parameters).every(([name, value]) =>
      jsonEqual(inForce(operation, parameters, name), value),
    ),
  );
  return (
    <div class="field-line">
      <label for={id} {...tipHandlers(list.help, 'left')}>
        {list.title}
      </label>
      <select
        id={id}
        class="select"
        aria-describedby={`${id}-help`}
        value={chosen?.name ?? ''}
        onChange={(event) => {
          const preset = list.presets.find(({ name }) => name === event.currentTarget.value);
          if (preset) onChoose(preset.parameters, `Use ${preset.title}`);
        }}
      >
        {chosen ? null : <option value="">Own values</option>}
        {list.presets.map(({ name, title }) => (
          <option key={name} value={name}>
            {title}
          </option>
        ))}
      </select>
      <span id={`${id}-help`} class="hidden-text">
        {list.help}
      </span>
      {chosen?.hint ? <p class="hint">{chosen.hint}</p> : null}
    </div>
  );
}
