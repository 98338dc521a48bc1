// SPDX-License-Identifier: GPL-3.0-or-later
import { useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { Button, formatCount, formatDuration, JobStrip, Segmented, Sheet, Switch } from '../../ui';
import { download } from '../../shared/session/download';
import '../../shared/panels/room.css';
import { RunningStrip } from '../../shared/panels/room_strip';
import { goOn, start, startReason } from './actions';
import { AlarmBar, MachineNotes } from './panel/alarm_bar';
import { BedView } from './bed/bed_view';
import { followBridge } from './bridge_machines';
import { Confirmation } from './panel/confirm';
import { Console } from './panel/console';
import { Inspector } from './inspector';
import { JobBar, partWords, timeShown } from './panel/job_bar';
import { jobWords } from './panel/state_words';
import './panel/machine_state.css';
import './machines.css';
import type { MachinesSession } from './machines_session';
import { PathView } from './bed/path_view';
import { sampleDrawing, sampleName } from './sample_drawing';

export interface MachinesPageProps {
  readonly session: MachinesSession;
  readonly onChooseFile: () => void;
  /** The project's cutting plan, for a bed of this width and depth in mm. */
  readonly onLayOutAgain: (bed_mm: readonly [number, number]) => void;
}

export function MachinesPage({ session, onChooseFile, onLayOutAgain }: MachinesPageProps) {
  const shown = useSignal<'bed' | 'path' | 'console'>('bed');
  const travel = useSignal(false);
  const paths = useSignal(false);
  useEffect(() => followBridge(session), [session]);
  useMachineKeys(session);
  const { drawing } = session.document.value;
  const plan = session.plan.value;
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
              {
                value: 'path',
                label: '3D',
                disabledReason: plan ? undefined : 'Available when there is a job',
              },
              { value: 'console', label: 'Console' },
            ]}
          />
          {shown.value === 'path' && plan?.carved ? (
            <div class="panel travel-switch">
              <Switch
                label="Show tool paths"
                value={paths.value}
                onChange={(value) => (paths.value = value)}
              />
            </div>
          ) : null}
          {shown.value !== 'console' && plan ? (
            <div class="panel travel-switch">
              <Switch
                label="Show travel moves"
                value={travel.value}
                onChange={(value) => (travel.value = value)}
              />
            </div>
          ) : null}
        </div>
        {shown.value === 'console' ? (
          <Console session={session} />
        ) : shown.value === 'path' && plan ? (
          <PathView session={session} showPaths={paths.value} showTravel={travel.value} />
        ) : (
          <BedView session={session} showTravel={travel.value} />
        )}
        {drawing === null && shown.value === 'bed' ? (
          <Empty session={session} onChooseFile={onChooseFile} />
        ) : null}
        <div class="machines-foot">
          <MachineNotes session={session} onChooseFile={onChooseFile} onLayOutAgain={onLayOutAgain} />
          {shown.value === 'console' ? null : <JobBar session={session} />}
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

function Empty({ session, onChooseFile }: Omit<MachinesPageProps, 'onLayOutAgain'>) {
  return (
    <div class="machines-empty">
      {session.isMill ? (
        <p>Reliefs come from Relief; models, height maps (PNG) and jobs (G-code) from a file.</p>
      ) : (
        <p>Cutting plans come from Zippable; drawings (SVG) and jobs (G-code) from a file.</p>
      )}
      <div class="row">
        <Button icon="upload" onClick={onChooseFile}>
          {session.isMill ? 'Open a model or a job' : 'Open a drawing or a job'}
        </Button>
        {session.isMill ? null : (
          <Button onClick={() => void session.take(sampleName, sampleDrawing())}>Try a sample drawing</Button>
        )}
      </div>
    </div>
  );
}

function Strip({ session, onChooseFile }: Omit<MachinesPageProps, 'onLayOutAgain'>) {
  const { control } = session;
  const plan = session.plan.value;
  const { cutOff } = control;
  const state = control.state.value;
  const job = state?.job ?? cutOff.value?.job;
  const ofThis = (state?.job ? control.loaded.value : cutOff.value?.key) === session.jobKey.value;
  const ending = session.jobFormat.split('.').at(-1) ?? 'gcode';
  const exportJob = plan?.jobs.map(({ stage, bytes }, index) => (
    <Button
      key={stage}
      size="small"
      icon="download"
      onClick={() =>
        download(
          bytes,
          `${session.title}${stage ? `_${index + 1}_${stage}` : ''}.${ending}`,
          'application/octet-stream',
        )
      }
    >
      {stage === '' ? 'Job file' : stage === 'rough' ? 'Roughing file' : 'Finishing file'}
    </Button>
  ));
  const another = (
    <Button size="small" kind="quiet" icon="upload" onClick={onChooseFile}>
      {session.isMill ? 'Another model' : 'Another drawing'}
    </Button>
  );
  const activity = session.activity.value;
  if (activity.kind !== 'idle')
    return (
      <RunningStrip
        activity={activity}
        titles={{ solving: 'Making the job', opening: 'Opening the model', exporting: 'Making the file' }}
        onCancel={() => session.cancel()}
      />
    );
  if (state && job && control.isBusy) {
    const seconds = plan && ofThis ? plan.toolPath.seconds : 0;
    const time = plan && ofThis ? (timeShown(session) ?? 0) : 0;
    const fraction = seconds > 0 ? time / seconds : job.acknowledged / Math.max(1, job.line_count);
    return (
      <JobStrip
        state="running"
        title={jobWords(state, job.name)}
        detail={
          plan && ofThis
            ? partWords(session, time)
            : `Line ${formatCount(job.acknowledged)} of ${formatCount(job.line_count)}`
        }
        progress={{ fraction, seconds_left: seconds > 0 ? (seconds - time) / control.pace.value : null }}
      />
    );
  }
  if (job && job.ended !== null && job.ended !== 'done') {
    const percent = Math.round((100 * job.acknowledged) / Math.max(1, job.line_count));
    const reason = ofThis ? startReason(session) : 'The job has changed since it was stopped';
    return (
      <JobStrip
        state="attention"
        title={`Job ${job.ended === 'cut_off' ? 'cut off' : job.ended} at ${percent} %`}
        detail={`After ${formatDuration(job.seconds)}. ${job.careful_line === undefined ? 'It can be started again' : 'After homing, it can be continued'}`}
      >
        {job.careful_line === undefined ? null : (
          <Button size="small" disabledReason={reason} onClick={() => void goOn(session)}>
            {session.isMill ? 'Carve on from here' : 'Cut the rest'}
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
        detail={
          session.planning.value
            ? 'This takes a moment'
            : session.subject.value
              ? 'Press Make the job to see the tool path'
              : session.isMill
                ? 'Open a model or a job'
                : 'Open a drawing or a job'
        }
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
            : session.isCurrent.value
              ? 'Job ready'
              : 'The job shown is out of date'
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
