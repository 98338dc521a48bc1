// SPDX-License-Identifier: GPL-3.0-or-later
// How far a mill's job falls short of what was wanted, and the button that makes it.
import { Button, formatDuration, formatNumber, withUnit } from '../../../ui';
import { solveInFull } from '../../../shared/session/full_solve';
import { figure } from '../../../shared/session/report';
import { readyWorker } from '../../../shared/session/services';
import type { MachinesSession } from '../machines_session';

/** Of the report, in this order; labels and units are the operation's. */
const shownFigures = [
  'size_mm',
  'seconds_rough',
  'seconds_finish',
  'scallop_mm',
  'deviation_mean_mm',
  'deviation_p95_mm',
  'deviation_max_mm',
  'tool_deviation_mean_mm',
];

export function MillSection({ session }: { readonly session: MachinesSession }) {
  const plan = session.plan.value;
  const { report: fields = [] } = session.operation.value ?? {};
  if (plan === null || figure(plan.report, 'deviation_mean_mm') === null) return null;
  const words = (name: string, unit: string): string | null => {
    const value = plan.report[name];
    if (Array.isArray(value))
      return withUnit(value.map((one) => formatNumber(Number(one), 3)).join(' × '), unit);
    if (typeof value !== 'number') return null;
    return unit === 's' ? formatDuration(value) : withUnit(formatNumber(value, 2), unit);
  };
  const rows = shownFigures.flatMap((name) => {
    const field = fields.find((one) => one.name === name);
    const text = field && words(name, field.unit ?? '');
    return field && text ? [{ name, label: field.label, help: field.help, text }] : [];
  });
  return (
    <section class="section" aria-label="What is carved">
      <h3>What is carved</h3>
      {session.isCurrent.value ? null : (
        <p class="hint">
          These figures belong to the previous job. Make the job again to use the current settings.
        </p>
      )}
      <dl class="mill-figures">
        {rows.map(({ name, label, help, text }) => (
          <div key={name} title={help}>
            <dt>{label}</dt>
            <dd>{text}</dd>
          </div>
        ))}
      </dl>
    </section>
  );
}

/** With a tool for each, roughing and finishing are two jobs; z is set with the tool between them. */
export function MillJobs({ session }: { readonly session: MachinesSession }) {
  const jobs = session.plan.value?.jobs ?? [];
  if (jobs.length < 2) return null;
  const next = session.stage.value;
  return (
    <section class="section" aria-label="Jobs, in order">
      <h3>Jobs, in order</h3>
      <ol class="mill-jobs">
        {jobs.map(({ stage }, index) => (
          <li key={stage} aria-current={index === next ? 'step' : undefined}>
            {index > 0 ? (
              <p class="hint">Change the tool and lower its tip onto the stock. Start then sets z there.</p>
            ) : null}
            <span>{stage === 'rough' ? 'Roughing' : 'Finishing'}</span>
            {index === next ? (
              <em>next</em>
            ) : (
              <Button
                size="small"
                kind="quiet"
                disabledReason={session.control.isBusy ? 'A job is running' : undefined}
                onClick={() => session.chooseStage(index)}
              >
                Run this job next
              </Button>
            )}
          </li>
        ))}
      </ol>
    </section>
  );
}

/** A mill's job is made when it is asked for; then Start takes this place. */
export function MakeMillJob({ session }: { readonly session: MachinesSession }) {
  const { kind } = session.activity.value;
  const worker = readyWorker(session.services) !== null;
  const seconds = session.estimate_s.value;
  const where = worker ? 'in the worker program' : 'in the browser';
  return (
    <>
      <Button
        kind="filled"
        size="big"
        disabledReason={
          kind === 'solving'
            ? 'The job is being made; Esc cancels'
            : kind === 'idle'
              ? undefined
              : 'A file is being made or opened'
        }
        onClick={() => void solveInFull(session)}
      >
        {kind === 'solving' ? 'Making the job' : 'Make the job'}
      </Button>
      <p>
        {seconds === null
          ? `${where.charAt(0).toUpperCase()}${where.slice(1)}`
          : `About ${formatDuration(seconds)} ${where}`}
      </p>
    </>
  );
}
