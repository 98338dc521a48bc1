// SPDX-License-Identifier: GPL-3.0-or-later
import { formatDuration, formatMetres } from '../../ui';
import type { CraftResult } from '../../shared/session/craft_document';
import { CraftStrip } from '../../shared/panels/craft_strip';
import { figure } from '../../shared/session/report';
import { design, zippable } from './zippable_document';
import type { ZippableSession } from './zippable_session';

/** Edges keep their lengths to rounding; more would be a fault that must not be hidden. */
const lengthKept = 1e-9;

export function ResultsStrip({ session }: { session: ZippableSession }) {
  const activity = session.activity.value;
  // A ribbon says nothing of zipper, bed and rig: these stay as they are set.
  const own = session.operationNamed(design)?.parameters.properties ?? {};
  return (
    <CraftStrip
      session={session}
      titles={{
        solving: 'Making the ribbon',
        opening: 'Opening the model',
        exporting: activity.kind === 'idle' ? '' : `Making the ${activity.name}`,
        done: 'Ribbon unfolded',
        empty: 'No ribbon yet',
        failed: 'No ribbon',
      }}
      detailOf={madeLine}
      error={session.problem.value?.message}
      cornersOf={({ model }) => model.mesh.indices.length}
      usualParameter="width_mm"
      figureOf={zipperOf}
      figureName="zipper"
      onRestore={(one, label) =>
        session.services.projects.do(zippable.restoreResult(one, label, (name) => name in own))
      }
    />
  );
}

const zipperOf = ({ report }: CraftResult): string => {
  const length_mm = figure(report, 'zipper_length_mm');
  return length_mm === null ? '' : formatMetres(length_mm);
};

/** "Laid flat without stretching 1.3 s on the worker". */
function madeLine({ report, seconds, backend }: CraftResult): string {
  const error = figure(report, 'isometry_error');
  const kept = error !== null && error < lengthKept ? 'All lengths are kept. ' : '';
  return `${kept}${formatDuration(seconds)} ${backend === 'native' ? 'in the worker program' : 'in the browser'}`;
}
