// SPDX-License-Identifier: GPL-3.0-or-later
import { useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { Button, formatCount, formatDuration, JobStrip, Segmented, Sheet, Switch } from '../../ui';
import { download } from '../common/download';
import '../common/room.css';
import { goOn, start, startReason } from './actions';
import { AlarmBar, MachineNotes } from './alarm_bar';
import { BedView } from './bed_view';
import { followBridge } from './bridge_machines';
import { Confirmation } from './confirm';
import { Console } from './console';
import { Inspector } from './inspector';
import { JobBar, partWords, timeShown } from './job_bar';
import './machines.css';
import type { MachinesSession } from './machines_session';

export interface MachinesPageProps {
  readonly session: MachinesSession;
  readonly onChooseFile: () => void;
}

export function MachinesPage({ session, onChooseFile }: MachinesPageProps) {
  const shown = useSignal<'bed' | 'console'>('bed');
  const travel = useSignal(false);
  useEffect(() => followBridge(session), [session]);
  useMachineKeys(session);
  const { drawing } = session.document.value;
  return (
    <>
      <main class="view machines-view" aria-label="Machines">
        <h1 class="hidden-text">Machines</h1>
        <AlarmBar session={session} />
        <div class="machines-tools">
          <Segmented
            floating
            label="View"
            value={shown.value}
            onChange={(value) => (shown.value = value)}
            options={[
              { value: 'bed', label: 'Bed' },
              { value: 'console', label: 'Console' },
            ]}
          />
          {shown.value === 'bed' && session.plan.value ? (
            <div class="panel travel-switch">
              <Switch label="Travel" value={travel.value} onChange={(value) => (travel.value = value)} />
            </div>
          ) : null}
        </div>
        {shown.value === 'bed' ? (
          <BedView session={session} showTravel={travel.value} />
        ) : (
          <Console session={session} />
        )}
        {drawing === null && shown.value === 'bed' ? <Empty onChooseFile={onChooseFile} /> : null}
        <div class="machines-foot">
          <MachineNotes session={session} onChooseFile={onChooseFile} />
          {shown.value === 'bed' ? <JobBar session={session} /> : null}
        </div>
        <Confirmation />
      </main>
      <Sheet label="Machine and job">
        <Inspector session={session} />
      </Sheet>
      <footer class="strip">
        <Strip session={session} onChooseFile={onChooseFile} />
      </footer>
    </>
  );
}

function Empty({ onChooseFile }: { readonly onChooseFile: () => void }) {
  return (
    <div class="machines-empty">
      <p>Cutting plans come from Zippable; drawings (SVG) and jobs (G-code) from a file.</p>
      <Button icon="upload" onClick={onChooseFile}>
        Open a drawing or a job
      </Button>
    </div>
  );
}

function Strip({ session, onChooseFile }: MachinesPageProps) {
  const { control } = session;
  const plan = session.plan.value;
  const job = control.state.value?.job;
  const ofThis = control.loaded.value === plan?.key;
  const exportJob = plan?.job ? (
    <Button
      size="small"
      icon="download"
      onClick={() =>
        plan.job &&
        download(
          plan.job,
          `${session.title}.${session.jobFormat.split('.').at(-1) ?? 'gcode'}`,
          'application/octet-stream',
        )
      }
    >
      Job file
    </Button>
  ) : null;
  const another = (
    <Button size="small" kind="quiet" icon="upload" onClick={onChooseFile}>
      Another drawing
    </Button>
  );
  if (job && control.isBusy) {
    const seconds = plan && ofThis ? plan.toolPath.seconds : 0;
    const time = plan && ofThis ? (timeShown(session) ?? 0) : 0;
    const fraction = seconds > 0 ? time / seconds : job.acknowledged / Math.max(1, job.line_count);
    return (
      <JobStrip
        state="running"
        title={`Working on ${job.name}`}
        detail={
          plan && ofThis
            ? partWords(session, time)
            : `Line ${formatCount(job.acknowledged)} of ${formatCount(job.line_count)}`
        }
        progress={{ fraction, seconds_left: seconds > 0 ? seconds - time : null }}
      />
    );
  }
  if (job && job.ended !== null && job.ended !== 'done') {
    const percent = Math.round((100 * job.acknowledged) / Math.max(1, job.line_count));
    const reason = !ofThis
      ? 'The job was changed meanwhile'
      : !control.can('start')
        ? 'Home the machine first'
        : undefined;
    return (
      <JobStrip
        state="attention"
        title={`Job ${job.ended === 'cut_off' ? 'cut off' : job.ended} at ${percent} %`}
        detail={`After ${formatDuration(job.seconds)}. ${job.careful_line === undefined ? 'It can be started anew' : 'After homing, the rest can be cut'}`}
      >
        {job.careful_line === undefined ? null : (
          <Button size="small" disabledReason={reason} onClick={() => goOn(session)}>
            Cut the rest
          </Button>
        )}
        {another}
      </JobStrip>
    );
  }
  if (job?.ended === 'done')
    return (
      <JobStrip
        state="done"
        title={`${job.name} is done`}
        detail={`${formatCount(job.line_count)} lines in ${formatDuration(job.seconds)}`}
      >
        {exportJob}
        {another}
      </JobStrip>
    );
  if (plan === null)
    return (
      <JobStrip
        state="idle"
        title={session.planning.value ? 'Making the job' : 'No job yet'}
        detail={session.planning.value ? 'One moment' : 'Open a drawing or a job'}
      />
    );
  const lines = plan.report['line_count'];
  return (
    <JobStrip
      state={plan.misfits.length > 0 ? 'attention' : 'idle'}
      title={
        plan.misfits.length > 0
          ? 'The job does not fit'
          : session.planning.value
            ? 'Making the job'
            : 'Job ready'
      }
      detail={`About ${formatDuration(plan.toolPath.seconds)}${typeof lines === 'number' ? `, ${formatCount(lines)} lines` : ''}`}
    >
      {exportJob}
      {another}
    </JobStrip>
  );
}

/** Ctrl+Enter asks to start. Esc and Ctrl+. are listened for wherever one is: stop_keys.ts. */
function useMachineKeys(session: MachinesSession): void {
  useEffect(() => {
    const onKey = (event: KeyboardEvent) => {
      if (document.querySelector('dialog[open]') || event.key !== 'Enter') return;
      if (!(event.ctrlKey || event.metaKey) || startReason(session) !== undefined) return;
      event.preventDefault();
      event.stopPropagation();
      start(session);
    };
    document.addEventListener('keydown', onKey, true);
    return () => document.removeEventListener('keydown', onKey, true);
  }, [session]);
}
