// SPDX-License-Identifier: GPL-3.0-or-later
import { formatCount, formatDuration, formatFixed, JobStrip, useLasting } from '../../ui';
import type { CraftResult } from '../common/craft_document';
import { figure } from '../common/report';
import { Results } from '../common/results';
import { relief } from './relief_document';
import type { ReliefSession } from './relief_session';
import { solvedLine } from './report';

export function ResultsStrip({ session }: { session: ReliefSession }) {
  const activity = session.activity.value;
  const lasting = useLasting(activity.kind !== 'idle');
  const result = session.result.value;
  if (lasting && activity.kind !== 'idle') {
    const titles = {
      solving: 'Solving the relief',
      opening: 'Opening the model',
      exporting: 'Making the file',
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
    ? { state: 'done' as const, title: 'Relief ready', detail: solvedLine(result.seconds, result.report) }
    : previewLine(session);
  return (
    <JobStrip {...state}>
      <Results
        session={session}
        current={result}
        usualParameter="thickness_mm"
        figureOf={(one) => ({ short: errorText(one), spoken: `normal error ${errorText(one)}` })}
        onChoose={(one, label) => session.services.projects.do(relief.restoreResult(one, label))}
      />
    </JobStrip>
  );
}

function previewLine(session: ReliefSession) {
  const shown = session.shown.value;
  const errors = Object.values(session.fieldErrors.value);
  if (errors[0]) return { state: 'attention' as const, title: 'Not solved', detail: errors[0] };
  if (shown === null)
    return { state: 'idle' as const, title: 'No relief yet', detail: 'The preview comes first' };
  const seconds = session.previewSeconds.value;
  const triangles = `${formatCount(shown.mesh.indices.length / 3)} triangles`;
  return {
    state: 'idle' as const,
    title: session.previewing.value ? 'Preview' : 'Preview up to date',
    detail: seconds === null ? triangles : `${triangles}, ${formatDuration(seconds)} in the browser`,
  };
}

function errorText(result: CraftResult): string {
  const error = figure(result.report, 'normal_error_mean_deg');
  return error === null ? '' : `${formatFixed(error, 1)}°`;
}
