// SPDX-License-Identifier: GPL-3.0-or-later
import { formatDuration, JobStrip, useLasting } from '../../ui';
import type { CraftResult } from '../common/craft_document';
import { figure } from '../common/report';
import { Results } from '../common/results';
import { previewLine, RunningStrip } from '../common/room_strip';
import { metres } from './flat_ribbon';
import { zippable } from './zippable_document';
import type { ZippableSession } from './zippable_session';

/** Edges keep their lengths to rounding; more would be a fault that must not be hidden. */
const lengthKept = 1e-9;

export function ResultsStrip({ session }: { session: ZippableSession }) {
  const activity = session.activity.value;
  const lasting = useLasting(activity.kind !== 'idle');
  const result = session.result.value;
  if (lasting && activity.kind !== 'idle') {
    const titles = {
      solving: 'Making the ribbon',
      opening: 'Opening the model',
      exporting: `Making the ${activity.name}`,
    };
    return <RunningStrip activity={activity} titles={titles} onCancel={() => session.cancel()} />;
  }
  const state = result
    ? { state: 'done' as const, title: 'Ribbon unfolded', detail: madeLine(result) }
    : previewOf(session);
  return (
    <JobStrip {...state}>
      <Results
        session={session}
        current={result}
        usualParameter="width_mm"
        figureOf={(one) => ({ short: zipperOf(one), spoken: `zipper ${zipperOf(one)}` })}
        onChoose={(one, label) => session.services.projects.do(zippable.restoreResult(one, label))}
      />
    </JobStrip>
  );
}

const zipperOf = ({ report }: CraftResult): string => {
  const length_mm = figure(report, 'zipper_length_mm');
  return length_mm === null ? '' : metres(length_mm);
};

/** "Every length kept. 1.3 s on the worker". */
function madeLine({ report, seconds, backend }: CraftResult): string {
  const error = figure(report, 'isometry_error');
  const kept = error !== null && error < lengthKept ? 'Every length kept. ' : '';
  return `${kept}${formatDuration(seconds)} ${backend === 'native' ? 'on the worker' : 'in the browser'}`;
}

const previewOf = (session: ZippableSession) =>
  previewLine({
    error: Object.values(session.fieldErrors.value)[0] ?? session.problem.value?.message,
    failed: 'No ribbon',
    empty: 'No ribbon yet',
    corners: session.shown.value?.model.mesh.indices.length ?? null,
    seconds: session.previewSeconds.value,
    previewing: session.previewing.value,
  });
