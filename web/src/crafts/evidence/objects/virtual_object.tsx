// SPDX-License-Identifier: GPL-3.0-or-later
// An object that nobody made, with faults that the maker chooses: to see what a diagnosis finds.
import { useSignal } from '@preact/signals';
import { useId } from 'preact/hooks';
import type { Json, JsonObject, Operation } from '../../../jobs/contract';
import { Button, Dialog } from '../../../ui';
import { known, withoutDefaults } from '../../../shared/session/craft_document';
import { ParameterPanel } from '../../../shared/panels/parameters/parameter_panel';
import type { EvidenceSession } from '../evidence_session';
import { inventObject } from './invent_object';

export function VirtualObject({ session, operation }: { session: EvidenceSession; operation: Operation }) {
  const open = useSignal(false);
  return (
    <>
      <Button kind="quiet" onClick={() => (open.value = true)}>
        Try a virtual object
      </Button>
      {open.value ? (
        <Choice session={session} operation={operation} onClose={() => (open.value = false)} />
      ) : null}
    </>
  );
}

/** The faults are what this is about: elsewhere they are advanced, here they come first. */
const faultGroups = ['Machine faults', 'Measurement faults'];
const openGroups = [...faultGroups, 'Virtual scan'];
/** Something to find for who sets nothing. */
const usualFault: JsonObject = { heating_gradient_x: 0.3 };

function faultsFirst(operation: Operation): Operation {
  const entries = Object.entries(operation.parameters.properties);
  const isFault = ([, schema]: (typeof entries)[number]) => faultGroups.includes(schema['x-group'] ?? '');
  const plain = entries
    .filter(isFault)
    .map(([name, schema]) => [name, { ...schema, 'x-advanced': false }] as const);
  const others = entries.filter((entry) => !isFault(entry));
  return { ...operation, parameters: { properties: Object.fromEntries([...plain, ...others]) } };
}

interface ChoiceProps {
  readonly session: EvidenceSession;
  readonly operation: Operation;
  readonly onClose: () => void;
}

function Choice({ session, operation, onClose }: ChoiceProps) {
  const samples = session.services.catalog.value?.samples ?? [];
  const usual = samples.find(({ name }) => name === 'pyramid') ?? samples[0];
  const sample = useSignal(usual?.name ?? '');
  const parameters = useSignal<JsonObject>(known(operation, usualFault));
  const id = useId();
  const set = (name: string, value: Json) =>
    (parameters.value = withoutDefaults(operation, { ...parameters.value, [name]: value }));
  const make = () => {
    onClose();
    void inventObject(session, sample.value, parameters.value);
  };
  return (
    <Dialog title={operation.title} onClose={onClose}>
      <p>{operation.summary}</p>
      <div class="field-line">
        <label for={id}>Mould</label>
        <select
          id={id}
          class="select"
          value={sample.value}
          onChange={(event) => (sample.value = event.currentTarget.value)}
        >
          {samples.map(({ name, title }) => (
            <option key={name} value={name}>
              {title}
            </option>
          ))}
        </select>
      </div>
      <div class="virtual-parameters">
        <ParameterPanel
          operation={faultsFirst(operation)}
          parameters={parameters.value}
          openGroups={openGroups}
          errors={{}}
          onPreview={set}
          onCommit={() => undefined}
        />
      </div>
      <Button kind="filled" onClick={make}>
        Make the virtual object
      </Button>
    </Dialog>
  );
}
