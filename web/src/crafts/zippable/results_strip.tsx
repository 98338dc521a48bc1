// SPDX-License-Identifier: GPL-3.0-or-later
import { formatCount, formatDuration, JobStrip, useLasting } from '../../ui';
import type { CraftResult } from '../common/craft_document';
import { figure } from '../common/report';
import { Results } from '../common/results';
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
    return (
      <JobStrip
        state="running"
        title={titles[activity.kind]}
        detail={activity.progress?.stage ?? (activity.kind === 'opening' ? activity.name : 'Starting')}
        progress={activity.progress ?? { fraction: 0, seconds_left: null }}
        onCancel={() => session.cancel()}
      />
    );
  }
  const state = result
    ? { state: 'done' as const, title: 'Ribbon unfolded', detail: madeLine(result) }
    : previewLine(session);
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

function previewLine(session: ZippableSession) {
  const shown = session.shown.value;
  const error = Object.values(session.fieldErrors.value)[0] ?? session.problem.value?.message;
  if (error) return { state: 'attention' as const, title: 'No ribbon', detail: error };
  if (shown === null)
    return { state: 'idle' as const, title: 'No ribbon yet', detail: 'The preview comes first' };
  const seconds = session.previewSeconds.value;
  const triangles = `${formatCount(shown.model.mesh.indices.length / 3)} triangles`;
  return {
    state: 'idle' as const,
    title: session.previewing.value ? 'Preview' : 'Preview up to date',
    detail: seconds === null ? triangles : `${triangles}, ${formatDuration(seconds)} in the browser`,
  };
}
