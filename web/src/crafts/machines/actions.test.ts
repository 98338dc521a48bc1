// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import type { MachineState } from '../../machines/links/machine_state';
import { startReason } from './actions';
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
  expect(startReason(room('mill', onlyZ))).toMatch(/unknown: home it first/);
});
