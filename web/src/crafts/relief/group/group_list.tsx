// SPDX-License-Identifier: GPL-3.0-or-later
// The models of one relief: which there are, the chosen one in numbers, and what may be added.
import { useRef } from 'preact/hooks';
import type { PlacedModel } from '../../../shared/session/craft_document';
import { titleOf } from '../../../shared/session/craft_document';
import { Icon, IconButton, Menu } from '../../../ui';
import { NumberField } from '../forest/list/number_field';
import '../scene_fields.css';
import type { ReliefSession } from '../relief_session';
import type { Vector } from '../../../shared/geometry/rotation';

const axes = ['x', 'y', 'z'] as const;

export function GroupList({ session }: { readonly session: ReliefSession }) {
  const { group } = session;
  if (!group.available.value) return null;
  const models = group.models.value;
  const chosen = models?.[group.chosen.value];
  return (
    <section class="section" aria-label="Models" aria-busy={group.running.value}>
      {models ? (
        <>
          <h3>{models.length === 1 ? '1 model' : `${models.length} models`}</h3>
          <ul class="scene-list">
            {models.map(({ name }, i) => (
              <li key={i}>
                <button
                  type="button"
                  aria-pressed={group.chosen.value === i}
                  onClick={() => (group.chosen.value = i)}
                >
                  <span class="grow clip">{name}</span>
                </button>
              </li>
            ))}
          </ul>
        </>
      ) : null}
      {chosen ? <PlaceFields session={session} model={chosen} index={group.chosen.value} /> : null}
      <AddModel session={session} />
    </section>
  );
}

interface PlaceFieldsProps {
  readonly session: ReliefSession;
  readonly model: PlacedModel;
  readonly index: number;
}

function PlaceFields({ session, model, index }: PlaceFieldsProps) {
  const { group } = session;
  const { name } = model;
  const shown = group.held.value ?? model;
  const setOne = (field: 'turn_deg' | 'at_mm', axis: number, value: number) => {
    const place = shown[field].map((old, k) => (k === axis ? value : old)) as unknown as Vector;
    group.change(index, { [field]: place }, field === 'at_mm' ? `Move ${name}` : `Turn ${name}`);
  };
  const alone = (group.models.value?.length ?? 1) < 2;
  return (
    <>
      <header class="scene-head">
        <h3>{name}</h3>
        <IconButton icon="copy" label={`Duplicate ${name}`} onClick={() => group.duplicate(index)} />
        <IconButton
          icon="trash"
          label={alone ? 'A relief needs one model' : `Remove ${name}`}
          disabled={alone}
          onClick={() => group.remove(index)}
        />
      </header>
      <div class="scene-numbers">
        <NumberField
          label="Longest side"
          unit="mm"
          value={shown.size_mm}
          onChange={(size_mm) => {
            if (size_mm > 0) group.change(index, { size_mm }, `Change the size of ${name}`);
          }}
        />
      </div>
      {(
        [
          ['at_mm', 'Place, mm', 'Place'],
          ['turn_deg', 'Turn, °', 'Turn'],
        ] as const
      ).map(([field, legend, spoken]) => (
        <fieldset key={field} class="scene-place">
          <legend>{legend}</legend>
          {axes.map((axis, k) => (
            <NumberField
              key={axis}
              label={`${spoken} ${axis}`}
              shown={axis}
              unit=""
              value={shown[field][k] ?? 0}
              onChange={(value) => setOne(field, k, value)}
            />
          ))}
        </fieldset>
      ))}
    </>
  );
}

/** Samples, files, and models of the project's other rooms. */
function AddModel({ session }: { readonly session: ReliefSession }) {
  const input = useRef<HTMLInputElement>(null);
  const { group } = session;
  const catalog = session.services.catalog.value;
  const formats = catalog?.mesh_formats ?? [];
  const elsewhere = session.model.elsewhere.value.filter(({ source }) => source.kind !== 'group');
  const items = [
    { label: 'From a file', icon: 'upload' as const, onSelect: () => input.current?.click() },
    ...elsewhere.map((model) => ({
      label: `${titleOf(model.source)}, open in this project`,
      onSelect: () => void group.take(model),
    })),
    null,
    ...(catalog?.samples ?? []).map(({ name, title }) => ({
      label: title,
      onSelect: () => void group.add({ kind: 'sample', sample: name, title }),
    })),
  ];
  return (
    <div class="row">
      <Menu buttonClass="button outlined small scene-add" items={items}>
        <Icon name="plus" small /> {group.models.value ? 'Add a model' : 'Add another model'}
      </Menu>
      <input
        ref={input}
        type="file"
        hidden
        aria-label="File of another model"
        accept={formats.map(({ extension }) => `.${extension}`).join(',')}
        onChange={({ currentTarget }) => {
          const file = currentTarget.files?.[0];
          currentTarget.value = '';
          if (file) void group.addFile(file);
        }}
      />
    </div>
  );
}
