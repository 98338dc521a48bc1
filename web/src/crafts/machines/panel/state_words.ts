// SPDX-License-Identifier: GPL-3.0-or-later
// What a machine does, in one or two words, from what it reports.
import type { MachineState } from '../../../machines/links/machine_state';

const phaseWords: Record<MachineState['phase'], string> = {
  unknown: 'Waiting',
  idle: 'Ready',
  homing: 'Homing',
  jogging: 'Moving',
  running: 'Working',
  pausing: 'Pausing',
  paused: 'Paused',
  stopping: 'Stopping',
  alarm: 'Alarm',
  door: 'Door open',
  check: 'Check only',
  sleep: 'Asleep',
};

/** A machine at rest where a job was stopped, whose position is not known again, is not ready for the next. */
const restsStopped = ({ phase, job, position_known }: MachineState): boolean =>
  phase === 'idle' && !position_known && job !== null && job.ended !== null && job.ended !== 'done';

export function stateWords(state: MachineState | null): string {
  if (state === null) return 'Offline';
  if (state.connection === 'greeting') return 'Connecting';
  if (state.connection === 'silent') return 'No answer';
  if (state.phase === 'alarm' && state.alarm)
    return state.alarm.code > 0 ? `Alarm ${state.alarm.code}` : 'Locked';
  return restsStopped(state) ? 'Stopped' : phaseWords[state.phase];
}

/** What becomes of the job that runs: "Working on plate", "Paused: plate". */
export function jobWords(state: MachineState, name: string): string {
  const words = stateWords(state);
  return words === 'Working' ? `Working on ${name}` : `${words}: ${name}`;
}
