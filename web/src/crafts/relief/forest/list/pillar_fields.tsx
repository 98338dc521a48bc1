// SPDX-License-Identifier: GPL-3.0-or-later
// One pillar in numbers.
import { useId } from 'preact/hooks';
import { IconButton } from '../../../../ui';
import type { ForestSession } from '../forest_session';
import { NumberField } from './number_field';
import type { Pillar, Shape } from '../scene';
import {
  addPillar,
  changePillar,
  isShaped,
  movedPillar,
  outlinedPillar,
  placeOf,
  removePillar,
  shapedPillar,
  shapes,
  widenedPillar,
  widthOf,
} from '../scene';
import { outlineName, shapeNames } from '../views';

export interface PillarFieldsProps {
  readonly session: ForestSession;
  readonly pillar: Pillar;
  readonly index: number;
  readonly count: number;
}

export function PillarFields({ session, pillar, index, count }: PillarFieldsProps) {
  const id = useId();
  const name = `pillar ${index + 1}`;
  const set = (change: (pillar: Pillar) => Pillar, label: string) =>
    session.change((scene) => changePillar(scene, index, change), label);
  const [x, y] = placeOf(pillar);
  return (
    <section class="section scene-fields" aria-label={`Pillar ${index + 1}`}>
      <header class="scene-head">
        <h3>Pillar {index + 1}</h3>
        <IconButton
          icon="copy"
          label={`Duplicate ${name}`}
          onClick={() => {
            session.change((scene) => addPillar(scene, index, pillar), `Duplicate ${name}`);
            session.chosen.value = { kind: 'pillar', index: count };
          }}
        />
        <IconButton
          icon="trash"
          label={`Delete ${name}`}
          onClick={() => {
            session.change((scene) => removePillar(scene, index), `Delete ${name}`);
            session.chosen.value = null;
          }}
        />
      </header>
      <div class="field-line">
        <label for={id}>Shape</label>
        <select
          id={id}
          class="select"
          value={isShaped(pillar) ? pillar.shape : 'outline'}
          onChange={({ currentTarget: { value } }) =>
            set(
              (one) => (value === 'outline' ? outlinedPillar(one) : shapedPillar(one, value as Shape)),
              `Change the shape of ${name}`,
            )
          }
        >
          {shapes.map((shape) => (
            <option key={shape} value={shape}>
              {shapeNames[shape]}
            </option>
          ))}
          <option value="outline">{outlineName}</option>
        </select>
      </div>
      {isShaped(pillar) ? null : (
        <p class="hint">
          Drag the corners in the plan, or move them with the arrow keys. A press on the middle of a side adds
          one, Delete takes one away.
        </p>
      )}
      <div class="scene-numbers">
        <NumberField
          label="Pillar x"
          shown="x"
          unit="mm"
          value={x}
          onChange={(value) => set((one) => movedPillar(one, [value, y]), `Move ${name}`)}
        />
        <NumberField
          label="Pillar y"
          shown="y"
          unit="mm"
          value={y}
          onChange={(value) => set((one) => movedPillar(one, [x, value]), `Move ${name}`)}
        />
        <NumberField
          label="Width of the pillar"
          shown="Width"
          unit="mm"
          value={widthOf(pillar)}
          onChange={(width) => set((one) => widenedPillar(one, width), `Change the width of ${name}`)}
        />
        <NumberField
          label="Height of the pillar"
          shown="Height"
          unit="mm"
          value={pillar.height_mm}
          onChange={(height_mm) => set((one) => ({ ...one, height_mm }), `Change the height of ${name}`)}
        />
        {isShaped(pillar) && pillar.shape !== 'round' ? (
          <NumberField
            label="Turn of the pillar"
            shown="Turn"
            unit="°"
            value={pillar.turn_deg ?? 0}
            onChange={(turn_deg) => set((one) => ({ ...one, turn_deg }), `Turn ${name}`)}
          />
        ) : null}
      </div>
    </section>
  );
}
