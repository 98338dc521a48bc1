// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import type { MachineState } from '../../machines/links/machine_state';
import { startReason, zOptions } from './actions';
import type { MachinesSession } from './machines_session';

const idle: Pick<MachineState, 'phase' | 'position_known' | 'axes_known' | 'can'> = {
  phase: 'idle',
  position_known: true,
  axes_known: { x: true, y: true, z: false },
  can: ['home', 'start'],
};

/** A room whose job is made and whose machine is connected. */
const room = (tool: 'laser' | 'mill', state: object): MachinesSession =>
  ({
    control: { state: { value: state }, isBusy: false },
    plan: { value: { misfits: [], jobs: [] } },
    job: { value: { stage: '', bytes: new Uint8Array(1) } },
    needsZ: false,
    planning: { value: false },
    isCurrent: { value: true },
    subject: { value: null },
    isMill: tool === 'mill',
    profiles: { current: { options: { tool } } },
    document: { value: { drawing: { kind: tool === 'mill' ? 'model' : 'drawing' } } },
  }) as unknown as MachinesSession;

it('a mill waits until its z is set, a laser does not', () => {
  expect(startReason(room('laser', idle))).toBeUndefined();
  expect(startReason(room('mill', idle))).toMatch(/set z/);
  expect(startReason(room('mill', { ...idle, axes_known: { x: true, y: true, z: true } }))).toBeUndefined();
});

it('an origin of z alone is not where the head stands', () => {
  const onlyZ = { ...idle, position_known: false, axes_known: { x: false, y: false, z: true } };
  expect(startReason(room('mill', onlyZ))).toMatch(/unknown: home the machine first/);
});

it('a mill’s start asks where z is 0, and says where and when it was set', () => {
  const state = (z_choice: MachineState['z_choice']) => ({ ...idle, z_choice }) as MachineState;
  const now = new Date(2026, 0, 2, 15, 0, 0);
  const labels = (z_choice: MachineState['z_choice']) =>
    zOptions(state(z_choice), now)?.map(({ value, label }) => `${value}: ${label}`);
  expect(labels(null)).toBeUndefined();
  expect(zOptions(null, now)).toBeNull();
  const known = labels({ origin_machine_mm: -12.5, set_seconds_ago: 600 });
  expect(known?.[0]).toMatch(/^here: Set z to the stock’s top here/);
  expect(known?.[1]).toMatch(/^kept: Keep z 0 at −12\.50\u2009mm in machine coordinates \(set at .*50/);
  expect(labels({ origin_machine_mm: 0, set_seconds_ago: null })?.[1]).toMatch(
    /at 0\.00\u2009mm .*set before the machine was connected/,
  );
  expect(labels({ origin_machine_mm: null, set_seconds_ago: 1 })?.[1]).toMatch(/Keep z 0 where it was set/);
});
