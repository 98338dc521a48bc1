// SPDX-License-Identifier: GPL-3.0-or-later
// One viewpoint in numbers: where its eye is, what it looks at, and the model that it shows there.
import { useId } from 'preact/hooks';
import { Button, IconButton } from '../../../../ui';
import { VectorField } from '../../../../shared/panels/parameters/vector_field';
import { titleOf } from '../../../../shared/session/craft_document';
import type { ForestSession } from '../forest_session';
import { NumberField } from './number_field';
import type { End, Place3, Viewpoint } from '../scene';
import { addViewpoint, changeViewpoint, removeViewpoint } from '../scene';

export interface ViewpointFieldsProps {
  readonly session: ForestSession;
  readonly viewpoint: Viewpoint;
  readonly index: number;
  readonly count: number;
  readonly onChooseFile: () => void;
}

const axes = ['x', 'y', 'z'] as const;
const endNames: Readonly<Record<End, string>> = { eye_mm: 'Eye', look_at_mm: 'Looks at' };
/** How a model from a file is seen until somebody turns it: as the core takes it. */
const frontDirection: Place3 = [0, 0, -1];
const frontUp: Place3 = [0, 1, 0];

export function ViewpointFields({ session, viewpoint, index, count, onChooseFile }: ViewpointFieldsProps) {
  const name = `viewpoint ${index + 1}`;
  const set = (change: Partial<Viewpoint>, label: string) =>
    session.change((scene) => changeViewpoint(scene, index, (one) => ({ ...one, ...change })), label);
  const setEnd = (end: End, axis: number, value: number) => {
    const place = viewpoint[end].map((old, k) => (k === axis ? value : old)) as unknown as Place3;
    set({ [end]: place }, `Move ${name}`);
  };
  return (
    <section class="section scene-fields" aria-label={`Viewpoint ${index + 1}`}>
      <header class="scene-head">
        <h3>Viewpoint {index + 1}</h3>
        <IconButton
          icon="copy"
          label={`Duplicate ${name}`}
          onClick={() => {
            session.change((scene) => addViewpoint(scene, index), `Duplicate ${name}`);
            session.chosen.value = { kind: 'viewpoint', index: count };
          }}
        />
        <IconButton
          icon="trash"
          label={count > 1 ? `Delete ${name}` : 'A forest needs one viewpoint'}
          disabled={count < 2}
          onClick={() => {
            session.change((scene) => removeViewpoint(scene, index), `Delete ${name}`);
            session.chosen.value = null;
          }}
        />
      </header>
      <ModelChoice session={session} viewpoint={viewpoint} index={index} onChooseFile={onChooseFile} />
      <div class="scene-numbers">
        <NumberField
          label="Width of the model"
          unit="mm"
          value={viewpoint.width_mm}
          onChange={(width_mm) => set({ width_mm }, `Change the width of ${name}`)}
        />
        {viewpoint.vertices === undefined ? null : (
          <NumberField
            label="Vertices"
            unit=""
            integer
            value={viewpoint.vertices}
            onChange={(vertices) => set({ vertices }, `Change the detail of ${name}`)}
          />
        )}
      </div>
      {(['eye_mm', 'look_at_mm'] as const).map((end) => (
        <fieldset key={end} class="scene-place">
          <legend>{endNames[end]}, mm</legend>
          {axes.map((axis, k) => (
            <NumberField
              key={axis}
              label={`${endNames[end]} ${axis}`}
              shown={axis}
              unit=""
              value={viewpoint[end][k] ?? 0}
              onChange={(value) => setEnd(end, k, value)}
            />
          ))}
        </fieldset>
      ))}
      {viewpoint.model === undefined ? null : (
        <>
          <VectorField
            label="Model seen along"
            help="The direction in which the viewer looks at the model, in its own axes."
            value={viewpoint.direction ?? frontDirection}
            onChange={(direction) =>
              set({ direction: direction as unknown as Place3 }, `Turn the model of ${name}`)
            }
          />
          <VectorField
            label="Upwards in the picture"
            help="Which of the model’s own axes is up. Models for 3D printing have z up: 0, 0, 1."
            value={viewpoint.up ?? frontUp}
            onChange={(up) => set({ up: up as unknown as Place3 }, `Turn the model of ${name}`)}
          />
        </>
      )}
    </section>
  );
}

type ModelChoiceProps = Omit<ViewpointFieldsProps, 'count'>;

/** Samples, files of this forest, and models of the project's other rooms. */
function ModelChoice({ session, viewpoint, index, onChooseFile }: ModelChoiceProps) {
  const id = useId();
  const samples = session.services.catalog.value?.samples ?? [];
  const { models } = session.document.value;
  const elsewhere = session.elsewhere.value.filter(({ mesh }) =>
    models.every(({ file }) => file.blob !== mesh.blob),
  );
  const value =
    viewpoint.model === undefined ? `sample ${viewpoint.sample ?? ''}` : `file ${viewpoint.model}`;
  const choose = (choice: string) => {
    const [kind, which = ''] = choice.split(' ');
    const taken = elsewhere[Number(which)];
    const vertices = viewpoint.vertices === undefined ? {} : { vertices: viewpoint.vertices };
    if (kind === 'sample') session.setSource(index, { sample: which, ...vertices });
    else if (kind === 'file') session.setSource(index, { model: Number(which) });
    else if (taken) session.takeModel(index, taken);
  };
  return (
    <>
      <div class="field-line">
        <label for={id}>Model</label>
        <select id={id} class="select" value={value} onChange={(event) => choose(event.currentTarget.value)}>
          {models.map(({ file_name }, i) => (
            <option key={`file ${i + 1}`} value={`file ${i + 1}`}>
              {file_name}
            </option>
          ))}
          {elsewhere.map((model, i) => (
            <option key={`room ${i}`} value={`room ${i}`}>
              {titleOf(model.source)}, open in this project
            </option>
          ))}
          {samples.map(({ name, title }) => (
            <option key={name} value={`sample ${name}`}>
              {title}
            </option>
          ))}
        </select>
      </div>
      <Button size="small" icon="upload" onClick={onChooseFile}>
        Open a model for it
      </Button>
    </>
  );
}
