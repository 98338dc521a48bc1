// SPDX-License-Identifier: GPL-3.0-or-later
import { formatFixed, JobStrip, useLasting } from '../../ui';
import type { CraftResult } from '../common/craft_document';
import { figure } from '../common/report';
import { Results } from '../common/results';
import { previewLine, RunningStrip } from '../common/room_strip';
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
    return <RunningStrip activity={activity} titles={titles} onCancel={() => session.cancel()} />;
  }
  const state = result
    ? { state: 'done' as const, title: 'Relief ready', detail: solvedLine(result.seconds, result.report) }
    : previewOf(session);
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

function errorText(result: CraftResult): string {
  const error = figure(result.report, 'normal_error_mean_deg');
  return error === null ? '' : `${formatFixed(error, 1)}°`;
}

const previewOf = (session: ReliefSession) =>
  previewLine({
    error: Object.values(session.fieldErrors.value)[0],
    failed: 'Not solved',
    empty: 'No relief yet',
    corners: session.shown.value?.mesh.indices.length ?? null,
    seconds: session.previewSeconds.value,
    previewing: session.previewing.value,
  });
