// SPDX-License-Identifier: GPL-3.0-or-later
import { Button, Icon, Menu } from '../../ui';
import type { CraftDocument } from '../session/craft_document';
import { titleOf } from '../session/craft_document';
import type { ModelRoom } from '../session/opened_model';
import { modelLine, sentences } from '../session/report';

export interface ModelRowProps<D extends CraftDocument> {
  readonly session: ModelRoom<D>;
  readonly picture: string | null;
  readonly onReplace: () => void;
}

/** The model at the head of the inspector. */
export function ModelRow<D extends CraftDocument>({ session, picture, onReplace }: ModelRowProps<D>) {
  const { model } = session.document.value;
  if (model === null) return null;
  const repairs = sentences(model.report, 'repairs').length;
  const elsewhere = session.model.elsewhere.value.filter(({ mesh }) => mesh.blob !== model.mesh.blob);
  return (
    <div class="model-row">
      <span
        class="model-picture"
        style={picture ? { backgroundImage: `url(${picture})` } : {}}
        aria-hidden="true"
      />
      <div class="grow">
        <strong class="clip">{titleOf(model.source)}</strong>
        <span class="model-line">{modelLine(model.report)}</span>
        {repairs > 0 ? (
          <button type="button" class="text-button" onClick={() => (session.model.repairsOpen.value = true)}>
            {repairs === 1 ? '1 repair' : `${repairs} repairs`}
          </button>
        ) : null}
      </div>
      {elsewhere.length > 0 ? (
        <Menu
          buttonClass="button outlined normal"
          align="right"
          items={[
            ...elsewhere.map((other) => ({
              label: titleOf(other.source),
              hint: 'Open in this project',
              onSelect: () => session.model.take(other),
            })),
            { label: 'Another model', icon: 'upload', onSelect: onReplace },
          ]}
        >
          Replace
          <Icon name="chevronDown" small />
        </Menu>
      ) : (
        <Button onClick={onReplace}>Replace</Button>
      )}
    </div>
  );
}
