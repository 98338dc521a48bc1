// SPDX-License-Identifier: GPL-3.0-or-later
// The job in time: to be played before, and followed while it runs.
import { useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { partAt, timeOfLine } from '../../../machines/toolpath';
import { IconButton } from '../../../ui';
import type { MachinesSession } from '../machines_session';

/** The machine works on what is shown. */
const isRunningThis = (session: MachinesSession): boolean =>
  session.control.loaded.value !== null &&
  session.control.loaded.value === session.jobKey.value &&
  session.control.isBusy;

/** Seconds into the job that the bed shows; null: the whole job. */
export function timeShown(session: MachinesSession): number | null {
  const plan = session.plan.value;
  const job = session.control.state.value?.job;
  if (plan && job && isRunningThis(session))
    return timeOfLine(plan.toolPath, job.line_now, session.stage.value);
  const stopped =
    job &&
    job.ended !== null &&
    job.ended !== 'done' &&
    session.control.loaded.value === session.jobKey.value;
  if (plan && stopped && session.playhead.value === null)
    return timeOfLine(plan.toolPath, job.line_now, session.stage.value);
  return session.playhead.value;
}

const clock = (seconds: number): string => {
  const whole = Math.round(seconds);
  const [minutes, rest] = [Math.floor(whole / 60), String(whole % 60).padStart(2, '0')];
  return minutes < 60
    ? `${minutes}:${rest}`
    : `${Math.floor(minutes / 60)}:${String(minutes % 60).padStart(2, '0')}:${rest}`;
};

const layerWords: Record<string, string> = {
  cut: 'cut',
  mark: 'mark',
  engrave: 'engraving',
  rough: 'roughing',
  finish: 'finishing',
};

/** "Part A3, cut". */
export function partWords(session: MachinesSession, time_s: number): string {
  const plan = session.plan.value;
  const part = plan && partAt(plan.toolPath, time_s);
  if (!part) return '';
  if (part.kind === 'travel') return session.isMill ? 'Travel' : 'Travel, laser off';
  const layer = layerWords[part.layer] ?? part.layer;
  return part.part ? `Part ${part.part}, ${layer}` : `${layer.charAt(0).toUpperCase()}${layer.slice(1)}`;
}

export function JobBar({ session }: { readonly session: MachinesSession }) {
  const playing = useSignal(false);
  const plan = session.plan.value;
  const seconds = plan?.toolPath.seconds ?? 0;
  const running = isRunningThis(session);
  const shown = timeShown(session) ?? seconds;
  useEffect(() => {
    if (!playing.value || running || plan === null) return undefined;
    // However long the job, it plays in about ten seconds.
    const speed = Math.max(1, seconds / 10);
    let last = performance.now();
    let frame = requestAnimationFrame(function step(now) {
      const next = (session.playhead.value ?? 0) + (speed * (now - last)) / 1000;
      last = now;
      session.playhead.value = next >= seconds ? null : next;
      if (next >= seconds) playing.value = false;
      else frame = requestAnimationFrame(step);
    });
    return () => cancelAnimationFrame(frame);
  }, [playing.value, running, plan]);
  if (plan === null) return null;
  const toggle = () => {
    if (!playing.value && session.playhead.value === null) session.playhead.value = 0;
    playing.value = !playing.value;
  };
  return (
    <div class="job-bar">
      <div class="job-bar-head">
        <IconButton
          icon={playing.value ? 'pause' : 'play'}
          label={playing.value ? 'Pause the preview' : 'Play the job'}
          disabled={running}
          onClick={toggle}
        />
        <strong class="clip">
          {timeShown(session) === null ? 'The whole job' : partWords(session, shown)}
        </strong>
        <span>
          {clock(shown)} of about {clock(seconds)}
        </span>
      </div>
      <input
        type="range"
        class="job-time"
        aria-label="Time in the job"
        aria-valuetext={`${clock(shown)} of ${clock(seconds)}`}
        min={0}
        max={seconds}
        step={seconds / 1000 || 1}
        value={shown}
        disabled={running}
        style={{ '--done': `${seconds > 0 ? (100 * shown) / seconds : 0}%` }}
        onInput={(event) => {
          const value = Number(event.currentTarget.value);
          session.playhead.value = value >= seconds ? null : value;
        }}
      />
    </div>
  );
}
