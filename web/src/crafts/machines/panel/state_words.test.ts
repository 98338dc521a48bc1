// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { MachineJob, MachineState } from '../../../machines/links/machine_state';
import { jobWords, stateWords } from './state_words';

const job = (ended: MachineJob['ended']): MachineJob => ({
  name: 'plate',
  line_count: 9,
  sent: 5,
  acknowledged: 4,
  line_now: 4,
  started_s: 0,
  seconds: 3,
  ended,
});
const state = (values: Partial<MachineState>): MachineState => ({
  controller: 'grbl',
  connection: 'ready',
  firmware: '1.1h',
  phase: 'idle',
  position_known: true,
  axes_known: { x: true, y: true, z: true },
  machine_mm: null,
  work_mm: null,
  speed_mm_per_s: 0,
  power_percent: 0,
  job: null,
  alarm: null,
  error: null,
  laser_on: false,
  warnings: [],
  when_connection_ends: '',
  z_choice: null,
  can: [],
  ...values,
});

describe('the words for a machine', () => {
  it('never call a paused machine working', () => {
    expect(jobWords(state({ phase: 'running', job: job(null) }), 'plate')).toBe('Working on plate');
    expect(jobWords(state({ phase: 'paused', job: job(null) }), 'plate')).toBe('Paused: plate');
    expect(jobWords(state({ phase: 'door', job: job(null) }), 'plate')).toBe('Door open: plate');
    expect(jobWords(state({ phase: 'stopping', job: job(null) }), 'plate')).toBe('Stopping: plate');
  });

  it('call a machine stopped, not ready, until its position is known again', () => {
    for (const ended of ['stopped', 'failed', 'cut_off'] as const) {
      expect(stateWords(state({ position_known: false, job: job(ended) }))).toBe('Stopped');
      expect(stateWords(state({ position_known: true, job: job(ended) }))).toBe('Ready');
    }
    expect(stateWords(state({ position_known: false, job: job('done') }))).toBe('Ready');
    expect(stateWords(state({ position_known: false }))).toBe('Ready');
  });

  it('name an alarm by its number and a lock by its word', () => {
    const alarm = (code: number) => state({ phase: 'alarm', alarm: { code, text: '', fix: '' } });
    expect(stateWords(alarm(2))).toBe('Alarm 2');
    expect(stateWords(alarm(0))).toBe('Locked');
    expect(stateWords(null)).toBe('Offline');
  });
});
