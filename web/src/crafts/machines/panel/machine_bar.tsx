// SPDX-License-Identifier: GPL-3.0-or-later
// A machine that works while another room is looked at: what it does, and Stop.
import { Button } from '../../../ui';
import type { MachinesSession } from '../machines_session';
import { jobWords } from './state_words';
import './machine_bar.css';

export function MachineBar({ session }: { readonly session: MachinesSession }) {
  const { control } = session;
  const state = control.state.value;
  if (state === null || !(control.isBusy || state.alarm)) return null;
  const job = state.job;
  const percent = job ? Math.round((100 * job.acknowledged) / Math.max(1, job.line_count)) : 0;
  return (
    <aside class="machine-bar" aria-label="The machine">
      <i class={state.alarm ? 'dot bad' : 'dot live'} />
      <a href="#/machines">
        {state.alarm
          ? `${control.machineName.value}: alarm`
          : `${jobWords(state, job?.name ?? 'a job')}, ${percent} %`}
      </a>
      <Button kind="danger" icon="stop" onClick={() => void control.command({ do: 'stop' })}>
        Stop
      </Button>
    </aside>
  );
}
