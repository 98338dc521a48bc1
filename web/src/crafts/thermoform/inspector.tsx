// SPDX-License-Identifier: GPL-3.0-or-later
// The parameters of forming and of what is made of the formed sheet, and the one filled button.
import { IconButton } from '../../ui';
import { machineProfile } from '../../shared/session/machine_profile';
import { ModelRow } from '../../shared/panels/model_row';
import { ParameterPanel } from '../../shared/panels/parameters/parameter_panel';
import { MainButton } from './export_button';
import type { FaceTool } from './stand/face_tool';
import { placeModel } from './stand/place_model';
import { StandButtons } from './stand/stand_buttons';
import type { ThermoformSession } from './thermoform_session';

export interface InspectorProps {
  readonly session: ThermoformSession;
  readonly tool: FaceTool;
  readonly picture: string | null;
  readonly onReplace: () => void;
  readonly onForm: () => void;
}

/** What a maker sets every time; the rest is folded. */
const openGroups = ['Placement', 'Sheet', 'Machine'];

/** The size that the core chose: of the model before it is turned. */
function automaticValues(session: ThermoformSession): Record<string, number> {
  const original = session.model.original.value;
  const placed = original && placeModel(session.inForce.value, original.mesh.positions);
  return placed ? { size_mm: placed.scale * placed.extent } : {};
}

export function Inspector({ session, tool, picture, onReplace, onForm }: InspectorProps) {
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
          onPreset={(values, label) => session.setParameters(values, label)}
          openGroups={openGroups}
          automatic={automaticValues(session)}
          groupHead={{ Placement: <StandButtons session={session} tool={tool} /> }}
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
