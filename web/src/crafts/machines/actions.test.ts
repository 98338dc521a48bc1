// SPDX-License-Identifier: GPL-3.0-or-later
import { signal } from '@preact/signals';
import { expect, it } from 'vitest';
import type { MachineCommand, MachineState } from '../../machines/links/machine_state';
import { practiceLaser } from '../../machines/profiles';
import { isZHere, offersPractice, practiceReason, practiseTheJob, startReason, zOptions } from './actions';
import { isAsking } from './panel/confirm';
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
    control: {
      state: { value: state },
      isBusy: false,
      practising: { value: false },
      zSets: { value: 0 },
      loaded: { value: 'job' },
    },
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

it('z is set at the tip after a change of tools; on a real machine z that was never set here is asked about', () => {
  const asks = { ...idle, z_choice: { origin_machine_mm: -12.5, set_seconds_ago: null } };
  const known = { ...asks, axes_known: { x: true, y: true, z: true } };
  const changed = { ...room('mill', known), needsZ: true } as unknown as MachinesSession;
  expect(isZHere(room('mill', known))).toBe(false);
  expect(isZHere(changed)).toBe(true);
  expect(startReason(changed)).toBeUndefined();
  // A driver that does not ask about z sets none at the start.
  const silent = {
    ...room('mill', { ...known, z_choice: null }),
    needsZ: true,
  } as unknown as MachinesSession;
  expect(isZHere(silent)).toBe(false);
  expect(startReason(silent)).toMatch(/set z here/);
  const practice = room('mill', known);
  Object.assign(practice.control, { practising: { value: true } });
  expect(isZHere(practice)).toBe(true);
  Object.assign(practice.control, { zSets: { value: 1 } });
  expect(isZHere(practice)).toBe(false);
});

/** A room with a practice machine that is to be connected, and the commands that it got. */
function practiceRoom(job: object = {}) {
  const commands: MachineCommand['do'][] = [];
  const [link, state] = [signal<object | null>(null), signal<object | null>(null)];
  const connecting = signal(false);
  const session = {
    ...room('laser', idle),
    control: {
      link,
      state,
      connecting,
      isBusy: false,
      command: (command: MachineCommand) => Promise.resolve(commands.push(command.do) > 0),
    },
    practise: () => {
      link.value = {};
      state.value = { ...idle, phase: 'alarm', position_known: false, alarm: { code: 0 }, can: ['home'] };
      return Promise.resolve();
    },
    jobKey: signal('job'),
    active: signal(true),
    profiles: { current: practiceLaser },
    ...job,
  } as unknown as MachinesSession;
  return { session, commands, link, connecting };
}

it('practising connects and asks about homing: no command is sent before the answer', async () => {
  const { session, commands, link } = practiceRoom();
  expect(offersPractice(session)).toBe(true);
  expect(practiceReason(session)).toBeUndefined();
  await practiseTheJob(session);
  expect(link.value).not.toBeNull();
  expect(isAsking()).toBe(true);
  expect(commands).toEqual([]);
  expect(offersPractice(session)).toBe(false); // Start and Stop stand there now
});

it('what does not fit or is out of date is not practised, and nothing is connected for it', async () => {
  const misfit = practiceRoom({ plan: { value: { misfits: ['It is too wide.'], jobs: [] } } });
  expect(practiceReason(misfit.session)).toBe('It is too wide.');
  await practiseTheJob(misfit.session);
  expect(misfit.link.value).toBeNull();
  expect(practiceReason(practiceRoom({ isCurrent: { value: false } }).session)).toMatch(/out of date/);
});
