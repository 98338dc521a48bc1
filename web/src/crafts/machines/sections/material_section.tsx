// SPDX-License-Identifier: GPL-3.0-or-later
// Powers, speeds and kerf that belong to a material, kept with the machine.
import { useSignal } from '@preact/signals';
import type { JsonObject } from '../../../jobs/contract';
import { Button, Dialog } from '../../../ui';
import type { MachinesSession } from '../machines_session';
import { materialNames } from './test_results';

export function MaterialSection({ session }: { readonly session: MachinesSession }) {
  const naming = useSignal<string | null>(null);
  const { profiles } = session;
  const { materials } = profiles.current;
  const operation = session.operation.value;
  const setNow = (): JsonObject =>
    Object.fromEntries(materialNames(operation).map((name) => [name, session.value(name)]));
  const fits = (parameters: JsonObject) =>
    Object.entries(parameters).every(([name, value]) => session.value(name) === value);
  const chosen = materials.findIndex(({ parameters }) => fits(parameters));
  const start = session.services.catalog.value?.laser_materials;
  const beginning = chosen < 0 ? start?.materials.find(({ parameters }) => fits(parameters)) : undefined;
  const choose = (value: string) => {
    const own = materials[Number(value)];
    if (own) session.setParameters(own.parameters, `Use ${own.name}`);
    const given = start?.materials.find(({ name }) => name === value);
    if (given) session.setParameters(given.parameters, `Use ${given.title}`);
  };
  const keep = (name: string) => {
    const others = materials.filter((material) => material.name !== name);
    profiles.put({ ...profiles.current, materials: [...others, { name, parameters: setNow() }] });
  };
  return (
    <section class="section" aria-label="Material">
      <h3>Material</h3>
      <div class="field-line">
        <label for="material-preset">Preset</label>
        <select
          id="material-preset"
          class="select"
          value={beginning?.name ?? String(chosen)}
          onChange={(event) => choose(event.currentTarget.value)}
        >
          <option value="-1">None: the values below</option>
          {materials.length > 0 ? (
            <optgroup label={`Saved with ${profiles.current.name}`}>
              {materials.map(({ name }, index) => (
                <option key={name} value={String(index)}>
                  {name}
                </option>
              ))}
            </optgroup>
          ) : null}
          {start?.lasers.map((laser) => (
            <optgroup key={laser.name} label={`Starting values: ${laser.title}`}>
              {start.materials
                .filter((material) => material.laser === laser.name)
                .map(({ name, title }) => (
                  <option key={name} value={name}>
                    {title}
                  </option>
                ))}
            </optgroup>
          ))}
        </select>
      </div>
      {beginning ? (
        <p class="hint">
          {start?.note} {beginning.hint}
        </p>
      ) : null}
      <div class="material-actions">
        <Button size="small" icon="frame" onClick={() => session.testMaterial()}>
          Test material
        </Button>
        <Button size="small" kind="quiet" onClick={() => (naming.value = materials[chosen]?.name ?? '')}>
          Save as a material
        </Button>
        {chosen >= 0 ? (
          <Button
            size="small"
            kind="quiet"
            onClick={() =>
              profiles.put({
                ...profiles.current,
                materials: materials.filter((_, index) => index !== chosen),
              })
            }
          >
            Delete
          </Button>
        ) : null}
      </div>
      {naming.value !== null ? (
        <Dialog title="Save as a material" onClose={() => (naming.value = null)}>
          <form
            class="add-machine"
            onSubmit={(event) => {
              event.preventDefault();
              const name = naming.value?.trim();
              if (name) keep(name);
              naming.value = null;
            }}
          >
            <label>
              Name
              <input
                type="text"
                maxLength={80}
                placeholder="Felt, 3 mm"
                value={naming.value}
                onInput={(event) => (naming.value = event.currentTarget.value)}
              />
            </label>
            <p class="hint">Powers, speeds, passes and kerf are saved with {profiles.current.name}.</p>
            <div class="dialog-actions">
              <Button onClick={() => (naming.value = null)}>Cancel</Button>
              <Button kind="filled" type="submit">
                Save
              </Button>
            </div>
          </form>
        </Dialog>
      ) : null}
    </section>
  );
}
