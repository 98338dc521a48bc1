// SPDX-License-Identifier: GPL-3.0-or-later
// The parameters of forming and of what is made of the formed sheet, and the one filled button.
import { ModelRow } from '../common/model_row';
import { ParameterPanel } from '../common/parameter_panel';
import { MainButton } from './export_button';
import type { ThermoformSession } from './thermoform_session';

export interface InspectorProps {
  readonly session: ThermoformSession;
  readonly picture: string | null;
  readonly onReplace: () => void;
  readonly onForm: () => void;
}

/** What a maker sets every time; the rest is folded. */
const openGroups = ['Placement', 'Sheet', 'Machine'];

export function Inspector({ session, picture, onReplace, onForm }: InspectorProps) {
  const { model, parameters } = session.document.value;
  const operation = session.operation.value;
  if (model === null || operation === null) return null;
  return (
    <>
      <div class="inspector-scroll" tabIndex={-1}>
        <ModelRow session={session} picture={picture} onReplace={onReplace} />
        <ParameterPanel
          operation={operation}
          parameters={parameters}
          errors={session.fieldErrors.value}
          onPreview={(name, value) => session.preview(name, value)}
          onCommit={() => session.services.projects.commit()}
          openGroups={openGroups}
        />
      </div>
      <div class="inspector-foot">
        <MainButton session={session} onForm={onForm} />
      </div>
    </>
  );
}
