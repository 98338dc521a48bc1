// SPDX-License-Identifier: GPL-3.0-or-later
// The machine, the layers in the order they are worked, the material, and everything else that can be set.
import { useSignal } from '@preact/signals';
import type { JsonObject } from '../../jobs/contract';
import { layersOf } from '../../machines/toolpath';
import { Button, Dialog, formatNumber, withUnit } from '../../ui';
import { ParameterPanel } from '../common/parameter_panel';
import { MachinePanel, StartAndStop } from './machine_panel';
import { OtherMachines } from './other_machines';
import type { MachinesSession } from './machines_session';

const layerTitles: Record<string, string> = {
  cut: 'Cut',
  mark: 'Mark',
  engrave: 'Engrave',
  rough: 'Roughing',
  finish: 'Finishing',
};
const materialGroups = ['Cut', 'Mark', 'Engrave', 'Cutting'];

export function Inspector({ session }: { readonly session: MachinesSession }) {
  const { parameters, drawing } = session.document.value;
  const operation = session.operation.value;
  return (
    <>
      <div class="inspector-scroll" tabIndex={-1}>
        <MachinePanel session={session} />
        <Layers session={session} />
        {operation && drawing?.kind === 'drawing' ? (
          <>
            <MaterialSection session={session} />
            <ParameterPanel
              operation={operation}
              parameters={parameters}
              errors={session.fieldErrors.value}
              onPreview={(name, value) => session.preview(name, value)}
              onCommit={() => session.services.projects.commit()}
              openGroups={['Placement']}
            />
          </>
        ) : null}
        <OtherMachines session={session} />
      </div>
      <div class="inspector-foot">
        <StartAndStop session={session} />
      </div>
    </>
  );
}

function Layers({ session }: { readonly session: MachinesSession }) {
  const plan = session.plan.value;
  if (plan === null) return null;
  const layers = layersOf(plan.toolPath);
  return (
    <section class="section" aria-label="Layers, in order">
      <h3>Layers, in order</h3>
      {layers.length === 0 ? (
        <p class="hint">Nothing to cut, mark or engrave: the drawing has notes only.</p>
      ) : null}
      <ul class="layer-list">
        {layers.map(({ layer, power_percent, speed_mm_per_s, parts }) => (
          <li key={layer}>
            <i class={`layer-${layer}`} />
            <span>
              {layerTitles[layer] ?? layer}, {parts === 1 ? '1 part' : `${parts} parts`}
            </span>
            <span>
              {withUnit(formatNumber(power_percent, 2), '%')},{' '}
              {withUnit(formatNumber(speed_mm_per_s, 3), 'mm/s')}
            </span>
          </li>
        ))}
      </ul>
    </section>
  );
}

/** Powers, speeds and kerf that belong to a material, kept with the machine. */
function MaterialSection({ session }: { readonly session: MachinesSession }) {
  const naming = useSignal<string | null>(null);
  const { profiles } = session;
  const { materials } = profiles.current;
  const operation = session.operation.value;
  const ofMaterial = (name: string) =>
    materialGroups.includes(operation?.parameters.properties[name]?.['x-group'] ?? '');
  const setNow = (): JsonObject =>
    Object.fromEntries(
      Object.keys(operation?.parameters.properties ?? {})
        .filter(ofMaterial)
        .map((name) => [name, session.value(name)]),
    );
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
          <option value="-1">As set below</option>
          {materials.length > 0 ? (
            <optgroup label={`Kept with ${profiles.current.name}`}>
              {materials.map(({ name }, index) => (
                <option key={name} value={String(index)}>
                  {name}
                </option>
              ))}
            </optgroup>
          ) : null}
          {start?.lasers.map((laser) => (
            <optgroup key={laser.name} label={`To begin with: ${laser.title}`}>
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
        <Button size="small" kind="quiet" onClick={() => (naming.value = materials[chosen]?.name ?? '')}>
          Keep what is set as a material
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
            Forget
          </Button>
        ) : null}
      </div>
      {naming.value !== null ? (
        <Dialog title="Keep as a material" onClose={() => (naming.value = null)}>
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
            <p class="hint">Powers, speeds, passes and kerf are kept with {profiles.current.name}.</p>
            <div class="dialog-actions">
              <Button onClick={() => (naming.value = null)}>Cancel</Button>
              <Button kind="filled" type="submit">
                Keep
              </Button>
            </div>
          </form>
        </Dialog>
      ) : null}
    </section>
  );
}
