// SPDX-License-Identifier: GPL-3.0-or-later
import { formatCount, formatDuration, formatNumber, JobStrip, useLasting, withUnit } from '../../ui';
import type { CraftResult } from '../common/craft_document';
import { figure } from '../common/report';
import { Results } from '../common/results';
import { previewLine, RunningStrip } from '../common/room_strip';
import { simulate, thermoform } from './thermoform_document';
import type { ThermoformSession } from './thermoform_session';

export function ResultsStrip({ session }: { session: ThermoformSession }) {
  const activity = session.activity.value;
  const lasting = useLasting(activity.kind !== 'idle');
  const result = session.result.value;
  if (lasting && activity.kind !== 'idle') {
    const titles = {
      solving: 'Forming the sheet',
      opening: 'Opening the model',
      exporting: `Making the ${activity.name}`,
    };
    return <RunningStrip activity={activity} titles={titles} onCancel={() => session.cancel()} />;
  }
  const own = session.operationNamed(simulate)?.parameters.properties ?? {};
  const state = result
    ? { state: 'done' as const, title: 'Sheet formed', detail: formedLine(result) }
    : previewOf(session);
  return (
    <JobStrip {...state}>
      <Results
        session={session}
        current={result}
        usualParameter="sheet_thickness_mm"
        figureOf={(one) => ({ short: thinnest(one), spoken: `thinnest ${thinnest(one)}` })}
        onChoose={(one, label) =>
          session.services.projects.do(thermoform.restoreResult(one, label, (name) => name in own))
        }
      />
    </JobStrip>
  );
}

const thinnest = ({ report }: CraftResult): string => {
  const thin = figure(report, 'thickness_min_mm');
  return thin === null ? '' : withUnit(formatNumber(thin, 2), 'mm');
};

/** "10,240 triangles, 8.9 s on the worker". */
function formedLine({ report, seconds, backend }: CraftResult): string {
  const triangles = figure(report, 'triangles');
  const where = backend === 'native' ? 'on the worker' : 'in the browser';
  const time = `${formatDuration(seconds)} ${where}`;
  return triangles === null ? time : `${formatCount(triangles)} triangles, ${time}`;
}

const previewOf = (session: ThermoformSession) =>
  previewLine({
    error: Object.values(session.fieldErrors.value)[0],
    failed: 'Not formed',
    empty: 'No sheet yet',
    corners: session.shown.value?.sheet.indices.length ?? null,
    seconds: session.previewSeconds.value,
    previewing: session.previewing.value,
  });
