// SPDX-License-Identifier: GPL-3.0-or-later
// The parameters of forming and of what is made of the formed sheet, and the one filled button.
import { IconButton } from '../../ui';
import { machineProfile } from '../../shared/session/machine_profile';
import { ModelRow } from '../../shared/panels/model_row';
import { ParameterPanel } from '../../shared/panels/parameters/parameter_panel';
import { placementNow } from './draw_scene';
import { MainButton } from './export_button';
import { boxOf, sizeBeforeTurning_mm } from './placement';
import type { ThermoformSession } from './thermoform_session';

export interface InspectorProps {
  readonly session: ThermoformSession;
  readonly picture: string | null;
  readonly onReplace: () => void;
  readonly onForm: () => void;
}

/** What a maker sets every time; the rest is folded. */
const openGroups = ['Placement', 'Sheet', 'Machine'];

/** The size that the core chose: of the model before it is turned. */
function automaticValues(session: ThermoformSession): Record<string, number> {
  const original = session.model.original.value;
  const placement = placementNow(session);
  if (original === null || placement === null) return {};
  return { size_mm: sizeBeforeTurning_mm(placement, boxOf(original.mesh.positions)) };
}

export function Inspector({ session, picture, onReplace, onForm }: InspectorProps) {
  const { model, parameters } = session.document.value;
  const operation = session.operation.value;
  if (model === null || operation === null) return null;
  return (
    <>
      <div class="inspector-scroll" tabIndex={-1}>
        <ModelRow session={session} picture={picture} onReplace={onReplace} />
        <ProfileLine session={session} />
        <ParameterPanel
          operation={operation}
          parameters={parameters}
          errors={session.fieldErrors.value}
          onPreview={(name, value) => session.preview(name, value)}
          onCommit={() => session.services.projects.commit()}
          openGroups={openGroups}
          automatic={automaticValues(session)}
        />
      </div>
      <div class="inspector-foot">
        <MainButton session={session} onForm={onForm} />
      </div>
    </>
  );
}

/** What is known of the machine, where something is; sheets, prints and moulds are made with it. */
function ProfileLine({ session }: { session: ThermoformSession }) {
  const profile = session.profile.value;
  if (profile === null) return null;
  return (
    <div class="profile-line">
      <span class="grow">
        Machine: <strong>{profile.name}</strong>
        <small>{profile.from}</small>
      </span>
      <IconButton
        icon="close"
        label="Form without the machine profile"
        onClick={() => session.services.projects.do(machineProfile.remove())}
      />
    </div>
  );
}
