// SPDX-License-Identifier: GPL-3.0-or-later
import { formatCount, formatDuration, formatFixed, JobStrip, useLasting, withUnit } from '../../../ui';
import { Results } from '../../../shared/panels/results';
import { RunningStrip } from '../../../shared/panels/room_strip';
import type { CraftResult } from '../../../shared/session/craft_document';
import { figure } from '../../../shared/session/report';
import type { ForestResult } from './forest_document';
import { forest } from './forest_document';
import type { ForestSession } from './forest_session';

const running = {
  solving: 'Making the forest',
  opening: 'Opening the scene',
  exporting: 'Making the file',
};

export function ForestStrip({ session }: { session: ForestSession }) {
  const activity = session.activity.value;
  const lasting = useLasting(activity.kind !== 'idle');
  if (lasting && activity.kind !== 'idle')
    return <RunningStrip activity={activity} titles={running} onCancel={() => session.cancel()} />;
  const result = session.result.value;
  return (
    <JobStrip {...(result ? doneLine(result) : planLine(session))}>
      <Results
        session={session}
        current={result}
        results={session.document.value.results}
        usualParameter="thickness_mm"
        nameOf={(one) => `${formatCount(figure(one.report, 'pillar_count') ?? 0)} pillars`}
        figureOf={(one) => ({ short: seen(one), spoken: `at least ${seen(one)} of each model seen` })}
        onChoose={(one, label) => {
          session.services.projects.do(forest.returnTo(one as ForestResult, label));
          session.chosen.value = null;
          session.commit();
        }}
      />
    </JobStrip>
  );
}

function seen({ report }: CraftResult): string {
  const least = figure(report, 'seen_percent_min');
  return least === null ? '–' : withUnit(formatFixed(least, 0), '%');
}

const doneLine = (result: CraftResult) => ({
  state: 'done' as const,
  title: 'Forest ready',
  detail: `Made in ${formatDuration(result.seconds)}. At least ${seen(result)} of each model is seen from its viewpoint`,
});

function planLine(session: ForestSession) {
  const problem = session.plan.problem.value ?? Object.values(session.fieldErrors.value)[0];
  if (problem) return { state: 'attention' as const, title: 'Not possible as it stands', detail: problem };
  const planned = session.plan.planned.value;
  if (planned === null)
    return {
      state: 'idle' as const,
      title: 'Looking at the pillars',
      detail: 'What each viewpoint sees is found first',
    };
  const pieces = planned.plan.viewpoints.reduce((sum, { surfaces }) => sum + surfaces.length, 0);
  return {
    state: 'idle' as const,
    title: session.plan.fits.value ? 'Plan up to date' : 'Plan',
    detail: `${formatCount(planned.made.pillars.length)} pillars with ${formatCount(pieces)} pieces`,
  };
}
