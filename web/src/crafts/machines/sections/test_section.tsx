// SPDX-License-Identifier: GPL-3.0-or-later
// A test on the material: what it is for, and what was read from it once it has been run.
import { useSignal } from '@preact/signals';
import type { JsonObject } from '../../../jobs/contract';
import { Button, formatNumber, Parameter, toast, withUnit } from '../../../ui';
import { laserJob } from '../machines_document';
import type { MachinesSession } from '../machines_session';
import type { TestCell } from './test_results';
import { cellsOf, layers, materialInForce, profileWith, settingsOf } from './test_results';

interface Props {
  readonly session: MachinesSession;
}

export function TestSection({ session }: Props) {
  const { drawing } = session.document.value;
  const kind = session.value('kind');
  const before = drawing?.kind === 'test' ? drawing.instead_of : null;
  return (
    <section class="section" aria-label="What the test shows">
      <h3>What the test shows</h3>
      {kind === 'power_speed' ? <BestSquare session={session} /> : null}
      {kind === 'kerf' ? <KerfRead session={session} /> : null}
      {kind === 'focus' ? (
        <p class="hint">
          The thinnest line is in focus. Its number says how much higher the head must stand than now; below
          zero, how much lower.
        </p>
      ) : null}
      <div class="material-actions">
        <Button
          size="small"
          kind="quiet"
          disabledReason={session.control.isBusy ? 'The test is being run' : undefined}
          onClick={() => session.endTest({}, 'End the test')}
        >
          {before ? `Back to ${before.file_name}` : 'Leave the test'}
        </Button>
      </div>
    </section>
  );
}

/** Sets the laser's jobs, keeps it with the material in force, and goes back to the drawing. */
function use(session: MachinesSession, found: JsonObject, label: string, words: string): void {
  const laser = session.operationCalled(laserJob);
  if (laser === null) return;
  const { current } = session.profiles;
  const parameters = session.document.value.set_aside[laserJob] ?? {};
  const material = materialInForce(current, laser, parameters);
  const changed = profileWith(current, laser, parameters, found);
  if (changed) session.profiles.put(changed);
  session.endTest(found, label);
  toast(material ? `${words}, and saved with ${material.name}.` : `${words}.`);
}

const percent = (cell: TestCell) => withUnit(formatNumber(cell.power_percent, 3), '%');
const speed = (cell: TestCell) => withUnit(formatNumber(cell.speed_mm_per_s, 3), 'mm/s');
const doing = { cut: 'cutting', mark: 'marking', engrave: 'engraving' } as const;

function BestSquare({ session }: Props) {
  const cells = cellsOf(session.plan.value?.report ?? {});
  const chosen = cells.find(({ name }) => name === session.chosenCell.value);
  const passes = session.value('passes');
  return (
    <>
      <p class="hint">
        Run the test, then choose the square that came out best, here or on the bed. Its power and speed
        become the setting for a layer.
      </p>
      <div class="field-line">
        <label for="best-square">Best square</label>
        <select
          id="best-square"
          class="select"
          value={chosen?.name ?? ''}
          onChange={(event) => (session.chosenCell.value = event.currentTarget.value || null)}
        >
          <option value="">None chosen</option>
          {cells.map((cell) => (
            <option key={cell.name} value={cell.name}>
              {percent(cell)} at {speed(cell)}
            </option>
          ))}
        </select>
      </div>
      <div class="use-square" role="group" aria-label="Use this square for">
        {layers.map((layer) => (
          <Button
            key={layer}
            size="small"
            disabledReason={
              session.control.isBusy
                ? 'The test is being run'
                : chosen
                  ? undefined
                  : 'Choose the best square first'
            }
            onClick={() => {
              if (chosen === undefined) return;
              const found = settingsOf(chosen, layer, typeof passes === 'number' ? passes : 1);
              const words = `${percent(chosen)} at ${speed(chosen)} is set for ${doing[layer]}`;
              use(session, found, `Set ${doing[layer]} from the test`, words);
            }}
          >
            Use for {doing[layer]}
          </Button>
        ))}
      </div>
    </>
  );
}

function KerfRead({ session }: Props) {
  const laser = session.operationCalled(laserJob);
  const schema = laser?.parameters.properties['kerf_mm'];
  const read = useSignal<number | null>(null);
  if (schema === undefined) return null;
  const fallback = typeof schema.default === 'number' ? schema.default : null;
  const unit = schema['x-unit'] ?? '';
  const shown = read.value ?? fallback;
  return (
    <>
      <p class="hint">
        Run the test and push the pieces to the left. The right edge of the last one points at the kerf on the
        scale.
      </p>
      <Parameter
        label="Kerf read from the scale"
        unit={unit}
        minimum={schema.minimum ?? 0}
        maximum={schema.maximum ?? Infinity}
        slider={schema['x-slider'] ?? null}
        defaultValue={fallback}
        value={shown}
        onPreview={(value) => (read.value = value)}
        onCommit={() => undefined}
      />
      <div class="use-square">
        <Button
          size="small"
          disabledReason={session.control.isBusy ? 'The test is being run' : undefined}
          onClick={() => {
            const kerf_mm = shown;
            if (kerf_mm === null) return;
            const words = `A kerf of ${withUnit(formatNumber(kerf_mm, 3), unit)} is set for cutting`;
            use(session, { kerf_mm }, 'Set the kerf from the test', words);
          }}
        >
          Use as the kerf
        </Button>
      </div>
    </>
  );
}
