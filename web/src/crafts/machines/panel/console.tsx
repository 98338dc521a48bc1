// SPDX-License-Identifier: GPL-3.0-or-later
// What was said to the machine and what it said; lines by hand; and the jobs it was given.
import { useSignal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import { Button, formatCount, formatDuration } from '../../../ui';
import { sendLine } from '../actions';
import type { MachinesSession } from '../machines_session';

const shownLines = 300;
const endWords: Record<string, string> = {
  done: 'done',
  stopped: 'stopped',
  failed: 'failed',
  cut_off: 'cut off',
};

export function Console({ session }: { readonly session: MachinesSession }) {
  const { control } = session;
  const link = control.link.value;
  const line = useSignal('');
  const history = useSignal<readonly string[]>([]);
  const at = useSignal(-1);
  const list = useRef<HTMLOListElement>(null);
  const events = link?.events.value.slice(-shownLines) ?? [];
  useEffect(() => {
    const element = list.current;
    // Follows the end unless the person has scrolled back.
    if (element && element.scrollHeight - element.scrollTop - element.clientHeight < 120)
      element.scrollTop = element.scrollHeight;
  }, [events.length, events.at(-1)]);
  const send = () => {
    const text = line.value.trim();
    if (text === '') return;
    history.value = [text, ...history.value.filter((old) => old !== text)].slice(0, 50);
    at.value = -1;
    line.value = '';
    sendLine(session, text);
  };
  const recall = (by: number) => {
    at.value = Math.max(-1, Math.min(history.value.length - 1, at.value + by));
    line.value = history.value[at.value] ?? '';
  };
  return (
    <div class="console">
      <ol ref={list} class="console-lines" tabIndex={0} aria-label="Messages from the machine">
        {events.length === 0 ? (
          <li class="note-line">{link ? 'No messages yet.' : 'Connect a machine to send commands to it.'}</li>
        ) : null}
        {events.map((event, index) => (
          <li key={`${event.now_s} ${index}`} class={event.event}>
            <span aria-hidden="true">{{ sent: '›', received: '‹', note: '•', ended: '■' }[event.event]}</span>
            <span class="hidden-text">{event.event}</span>
            {event.text ?? `job ${endWords[event.how ?? ''] ?? event.how}`}
          </li>
        ))}
      </ol>
      <form
        class="console-input"
        onSubmit={(event) => {
          event.preventDefault();
          send();
        }}
      >
        <input
          type="text"
          aria-label="Line to send"
          placeholder="$$, ?, G0 X10"
          autocomplete="off"
          spellcheck={false}
          maxLength={80}
          value={line.value}
          onInput={(event) => (line.value = event.currentTarget.value)}
          onKeyDown={(event) => {
            if (event.key !== 'ArrowUp' && event.key !== 'ArrowDown') return;
            event.preventDefault();
            recall(event.key === 'ArrowUp' ? 1 : -1);
          }}
        />
        <Button
          type="submit"
          size="small"
          disabledReason={control.can('send') ? undefined : 'Only while the machine is idle'}
        >
          Send
        </Button>
      </form>
      <JobHistory session={session} />
    </div>
  );
}

function JobHistory({ session }: { readonly session: MachinesSession }) {
  const jobs = session.log.jobs.value;
  if (jobs.length === 0) return null;
  return (
    <details class="job-history">
      <summary>{jobs.length === 1 ? '1 job' : `${formatCount(jobs.length)} jobs`} so far</summary>
      <ul>
        {jobs.map((job) => (
          <li key={job.id}>
            <strong class="clip">{job.name}</strong>
            <span>
              {job.machine}
              {job.practice ? ', practice' : ''}, {new Date(1000 * job.started_unix_s).toLocaleString()}
            </span>
            <span>
              {job.ended === null ? 'interrupted' : endWords[job.ended]}
              {job.seconds === null ? '' : ` after ${formatDuration(job.seconds)}`},{' '}
              {formatCount(job.lines_done)} of {formatCount(job.lines)} lines
            </span>
          </li>
        ))}
      </ul>
    </details>
  );
}
