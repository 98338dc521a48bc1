// SPDX-License-Identifier: GPL-3.0-or-later
// Model, parts, parameters, lengths and errors, and the one filled button.
import type { ComponentChildren } from 'preact';
import { ModelRow } from '../../shared/panels/model_row';
import { ParameterPanel } from '../../shared/panels/parameters/parameter_panel';
import { figure, vectorOf } from '../../shared/session/report';
import { MainButton } from './export_button';
import { Figures } from './figures';
import { PartList } from './drawing/part_list';
import { SewnButton } from './sewn/sewn_dialog';
import type { SendToMachine } from './sheets/send_sheet';
import { SheetSize } from './sheet_size_row';
import { flatView } from './views';
import { design, planning } from './zippable_document';
import type { ZippableSession } from './zippable_session';

export interface InspectorProps {
  readonly session: ZippableSession;
  readonly picture: string | null;
  readonly onReplace: () => void;
  readonly onSolve: () => void;
  readonly onSendToMachine: SendToMachine;
}

/** What the core chose where the maker left it open. */
function automaticValues(session: ZippableSession): Record<string, number> {
  const sizes = session.sheets.automatic.value;
  const shown = session.shown.value;
  if (shown === null) return sizes;
  const windings = shown.design.parts.map((part) => part.windings);
  const size = vectorOf(shown.report, 'size_mm');
  const width = figure(shown.report, 'ribbon_width_mean_mm');
  return {
    ...sizes,
    ...(windings.length > 0
      ? { windings: Math.round((10 * windings.reduce((a, b) => a + b, 0)) / windings.length) / 10 }
      : {}),
    ...(size ? { size_mm: Math.round(Math.max(...size)) } : {}),
    ...(width === null
      ? {}
      : { puncture_mm: Math.round(5 * width) / 10, sample_mm: Math.round(2 * width) / 10 }),
  };
}

/** What the right pane shows is what there is to set; the rest is folded away. */
function openGroups(session: ZippableSession): string[] {
  const operation = session.operationNamed(flatView.value === 'ribbon' ? design : planning);
  return Object.values(operation?.parameters.properties ?? {}).map((schema) => schema['x-group'] ?? '');
}

/** In the order of the groups; those of the plan only where there is one to make. */
function groupHeads(session: ZippableSession): Record<string, ComponentChildren> {
  const parts = { Ribbon: null, Parts: <PartList session={session} /> };
  if (session.operationNamed(planning) === undefined) return parts;
  return { ...parts, 'Zipper line': null, Zipper: null, Sheets: <SheetSize session={session} /> };
}

export function Inspector({ session, picture, onReplace, onSolve, onSendToMachine }: InspectorProps) {
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
          onPreset={(values, label) => session.setParameters(values, label)}
          groupHead={groupHeads(session)}
          automatic={automaticValues(session)}
          openGroups={openGroups(session)}
        />
        <Figures session={session} />
        <section class="section" aria-label="After sewing">
          <SewnButton session={session} />
        </section>
      </div>
      <div class="inspector-foot">
        <MainButton session={session} onSolve={onSolve} onSendToMachine={onSendToMachine} />
      </div>
    </>
  );
}
