// SPDX-License-Identifier: GPL-3.0-or-later
// The machine, the layers in the order they are worked, the material, and everything else that can be set.
import type { Operation } from '../../jobs/contract';
import { layersOf } from '../../machines/toolpath';
import { formatNumber, withUnit } from '../../ui';
import { ParameterPanel } from '../../shared/panels/parameters/parameter_panel';
import { MachinePanel, StartAndStop } from './panel/machine_panel';
import type { MachinesSession } from './machines_session';
import { MaterialSection } from './sections/material_section';
import { MakeMillJob, MillJobs, MillSection } from './sections/mill_section';
import { OtherMachines } from './panel/other_machines';
import { TestSection } from './sections/test_section';

const layerTitles: Record<string, string> = {
  cut: 'Cut',
  mark: 'Mark',
  engrave: 'Engrave',
  rough: 'Roughing',
  finish: 'Finishing',
};

export function Inspector({ session }: { readonly session: MachinesSession }) {
  const kind = session.document.value.drawing?.kind ?? null;
  const operation = session.operation.value;
  const toMake = kind === 'model' && !session.isCurrent.value && !session.control.isBusy;
  return (
    <>
      <div class="inspector-scroll" tabIndex={-1}>
        <MachinePanel session={session} />
        {kind === 'test' ? <TestSection session={session} /> : null}
        {kind === 'model' ? <MillJobs session={session} /> : null}
        {kind === 'model' ? <MillSection session={session} /> : null}
        <Layers session={session} />
        {kind === 'drawing' || (kind === null && !session.isMill) ? (
          <MaterialSection session={session} />
        ) : null}
        {operation && kind !== null && kind !== 'job' ? (
          <ParameterPanel
            key={operation.name}
            operation={operation}
            parameters={session.document.value.parameters}
            errors={session.fieldErrors.value}
            onPreview={(name, value) => session.preview(name, value)}
            onCommit={() => session.services.projects.commit()}
            onPreset={(values, label) => session.setParameters(values, label)}
            openGroups={openGroups(session, operation)}
          />
        ) : null}
        <OtherMachines session={session} />
      </div>
      <div class="inspector-foot">
        {toMake ? <MakeMillJob session={session} /> : null}
        {toMake && session.control.link.value === null ? null : <StartAndStop session={session} />}
      </div>
    </>
  );
}

/** What is set most often stands open, the rest is folded. */
function openGroups(session: MachinesSession, { name }: Operation): readonly string[] {
  if (name === 'mill-job') return ['Carving', 'Finishing', 'Roughing'];
  if (name === 'test-grid') return ['Test', session.value('kind') === 'power_speed' ? 'Squares' : 'Lines'];
  return ['Placement'];
}

/** "20 %", "20 to 100 %". */
const range = ([low, high]: readonly [number, number], digits: number, unit: string) =>
  withUnit([...new Set([low, high])].map((value) => formatNumber(value, digits)).join(' to '), unit);

function Layers({ session }: { readonly session: MachinesSession }) {
  const plan = session.plan.value;
  if (plan === null) return null;
  const layers = layersOf(plan.toolPath);
  const milled = session.document.value.drawing?.kind === 'model';
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
              {layerTitles[layer] ?? layer}
              {milled ? '' : `, ${parts === 1 ? '1 part' : `${parts} parts`}`}
            </span>
            <span>
              {milled ? '' : `${range(power_percent, 2, '%')}, `}
              {milled
                ? withUnit(formatNumber(speed_mm_per_s[1], 3), 'mm/s')
                : range(speed_mm_per_s, 3, 'mm/s')}
            </span>
          </li>
        ))}
      </ul>
    </section>
  );
}
