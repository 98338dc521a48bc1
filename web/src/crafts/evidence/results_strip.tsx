// SPDX-License-Identifier: GPL-3.0-or-later
import { formatCount, formatDuration, formatNumber, JobStrip, useLasting, withUnit } from '../../ui';
import type { CraftResult } from '../../shared/session/craft_document';
import { figure } from '../../shared/session/report';
import { Results } from '../../shared/panels/results';
import { RunningStrip } from '../../shared/panels/room_strip';
import { percent, readDiagnosis } from '../../shared/diagnosis/diagnosis';
import { diagnosing, evidence, usesIn } from './evidence_document';
import type { EvidenceSession } from './evidence_session';
import { measuredMarks } from './by_hand/hand_marks';
import { openingOf, planNow } from './by_hand/plan_marks';
import { measuredNow, isOfPhotographs, wordOf } from './scan/measure_scan';
import { distancesOf, meanOf } from './pictures/residuals';

export function ResultsStrip({ session }: { session: EvidenceSession }) {
  const activity = session.activity.value;
  const lasting = useLasting(activity.kind !== 'idle');
  if (lasting && activity.kind !== 'idle') {
    const titles = {
      solving: session.mode.value === 'diagnose' ? 'Diagnosing' : 'Calibrating',
      opening: `Opening ${activity.name}`,
      exporting: `Making the ${activity.name}`,
    };
    return <RunningStrip activity={activity} titles={titles} onCancel={() => session.cancel()} />;
  }
  const { objects, results } = session.document.value;
  const ours = results.filter((result) => usesIn(result.mesh, objects) !== null);
  return (
    <JobStrip {...stateOf(session)}>
      <Results
        session={session}
        current={session.result.value}
        usualParameter="triangles"
        results={ours}
        nameOf={(result) => nameOf(session, result)}
        figureOf={(result) => ({ short: shortOf(result), spoken: shortOf(result) })}
        onChoose={(result, label) => session.services.projects.do(evidence.returnTo(result, label))}
      />
    </JobStrip>
  );
}

const isDiagnosis = ({ mesh }: CraftResult) => mesh.startsWith(diagnosing);

function nameOf(session: EvidenceSession, result: CraftResult): string {
  const used = usesIn(result.mesh, session.document.value.objects)?.objects ?? [];
  const names = used.filter(({ use }) => use === 'fit').map(({ name }) => name);
  return names.length > 1 ? `${names[0] ?? ''} + ${names.length - 1}` : (names[0] ?? '');
}

function shortOf(result: CraftResult): string {
  if (!isDiagnosis(result)) return 'calibrated';
  const { reading, causes } = readDiagnosis(result.report);
  if (reading === 'none') return 'nothing found';
  if (reading === 'unknown') return 'unknown cause';
  return percent(causes[0]?.probability ?? 0);
}

function stateOf(session: EvidenceSession) {
  const { scan, byHand } = session.document.value;
  if (byHand && !scan) {
    const plan = planNow(session, byHand);
    const measured = plan ? measuredMarks(byHand, openingOf(byHand)).length : 0;
    return {
      state: 'idle' as const,
      title: plan ? 'Marks chosen' : 'Measure by hand',
      detail: plan
        ? `${measured} of ${byHand.marks.length} measured`
        : 'Press Choose the marks to find out where to measure',
    };
  }
  if (scan) {
    const measured = measuredNow(scan);
    return measured
      ? {
          state: 'done' as const,
          title: isOfPhotographs(scan) ? 'Photographs measured' : 'Scan measured',
          detail: `${formatCount(figure(measured.report, 'points') ?? 0)} points`,
        }
      : {
          state: 'idle' as const,
          title: isOfPhotographs(scan) ? 'Photographs opened' : 'Scan opened',
          detail: `Press Measure the ${wordOf(scan)} to find the points`,
        };
  }
  const result = session.result.value;
  if (result) {
    const where = result.backend === 'native' ? 'in the worker program' : 'in the browser';
    const simulations = figure(result.report, 'simulations');
    const made = simulations === null ? '' : `${formatCount(simulations)} simulations, `;
    return {
      state: 'done' as const,
      title: isDiagnosis(result) ? 'Diagnosis ready' : 'Calibration ready',
      detail: `${made}${formatDuration(result.seconds)} ${where}`,
    };
  }
  const error = Object.values(session.fieldErrors.value)[0];
  if (error) return { state: 'attention' as const, title: 'Some settings are invalid', detail: error };
  if (session.stopped.value)
    return {
      state: 'idle' as const,
      title: 'Stopped',
      detail:
        session.services.native === null
          ? 'The next run starts from the beginning'
          : 'Finished simulations are kept; the next run continues from there',
    };
  const look = session.look.value;
  if (look === null)
    return {
      state: 'idle' as const,
      title: session.looking.value ? 'Simulating this machine and mould' : 'Nothing compared yet',
      detail: 'Measured and simulated sheet are compared first',
    };
  const mean = meanOf(distancesOf(look.residuals, 'base'));
  return {
    state: 'idle' as const,
    title: 'Compared with the settings as they are',
    detail: `${withUnit(formatNumber(mean, 2), 'mm')} apart on average; not calibrated yet`,
  };
}
