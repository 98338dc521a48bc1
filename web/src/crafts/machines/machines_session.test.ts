// @vitest-environment happy-dom
// SPDX-License-Identifier: GPL-3.0-or-later
import { signal } from '@preact/signals';
import { expect, it, vi } from 'vitest';
import { practiceLaser, practiceMill } from '../../machines/profiles';
import { solveInFull } from '../../shared/session/full_solve';
import { resultOf, settled, testCatalog, testServices } from '../../shared/session/test_room';
import { laserJob, machines, millJob } from './machines_document';
import { MachinesSession } from './machines_session';

it('a mill’s job whose files are gone is said, and can be made again', async () => {
  const services = testServices(testCatalog(laserJob, millJob));
  const session = new MachinesSession(services);
  const file = { blob: 'lion', bytes: 3, media_type: 'application/octet-stream' };
  const work = { file_name: 'lion.stl', kind: 'model', file } as const;
  services.projects.do(machines.setWork(testCatalog(laserJob, millJob), work, 'Open'));
  services.projects.do(machines.addResult(resultOf('lion')));
  session.active.value = true;
  await settled();
  expect(session.problem.value?.title).toBe('The job cannot be read');
  expect(session.isCurrent.value).toBe(false);
  void solveInFull(session);
  expect(services.browser.runs).toMatchObject([{ asked: { operation: millJob } }]);
});

it('a drawing that is still being kept when another project is opened is not written into that one', async () => {
  const services = testServices(testCatalog(laserJob, millJob));
  const session = new MachinesSession(services);
  const file = { blob: 'star', bytes: 3, media_type: 'image/svg+xml' };
  services.projects.do(
    machines.setWork(testCatalog(laserJob, millJob), { file_name: 'own.svg', kind: 'drawing', file }, 'Open'),
  );
  const first = services.projects.document.value.id;
  vi.spyOn(session, 'keep').mockImplementation(async () => {
    await services.projects.create();
    return file;
  });
  expect(await session.take('star.svg', new Uint8Array(3))).toBe(false);
  expect(services.projects.document.value.id).not.toBe(first);
  expect(services.projects.isBlank.value).toBe(true);
});

it('a sheet of the cutting plan is known as one, until another drawing is opened', async () => {
  const session = new MachinesSession(testServices(testCatalog(laserJob, millJob)));
  expect(await session.take('star, sheet 1.svg', new Uint8Array(3), 'drawing', {}, { of_plan: true })).toBe(
    true,
  );
  expect(session.document.value.drawing).toMatchObject({ kind: 'drawing', of_plan: true });
  expect(await session.take('other.svg', new Uint8Array(4))).toBe(true);
  expect(session.document.value.drawing).not.toHaveProperty('of_plan');
});

it('a drawing is not taken while a real mill is connected', async () => {
  const session = new MachinesSession(testServices(testCatalog(laserJob, millJob)));
  session.useProfile(practiceMill);
  session.control.link.value = { state: signal(null), gone: signal(null), close: async () => {} } as never;
  expect(await session.take('star.svg', new Uint8Array(3))).toBe(false);
  expect(session.problem.value?.message).toMatch(/^Drawings are for lasers: disconnect the mill/);
  expect(session.document.value.drawing).toBeNull();
});

it('what a relief was sent to the mill with does not scale the file that is opened next', () => {
  const catalog = {
    ...testCatalog(laserJob, millJob),
    operations: testCatalog(laserJob, millJob).operations.map((operation) => ({
      ...operation,
      parameters: { properties: { width_mm: { title: 'Width' }, thickness_mm: { title: 'Depth' } } },
    })),
  };
  const services = testServices(catalog as unknown as Parameters<typeof testServices>[0]);
  const file = { blob: 'a', bytes: 3, media_type: 'image/png' };
  const open = (file_name: string, kind: 'model' | 'drawing', own = {}) =>
    services.projects.do(machines.setWork(catalog as never, { file_name, kind, file }, 'Open', own));
  const parameters = () => machines.of(services.projects.document.value).parameters;
  open('relief.png', 'model', { width_mm: 120, thickness_mm: 8 });
  expect(parameters()).toEqual({ width_mm: 120, thickness_mm: 8 });
  open('cat.stl', 'model');
  expect(parameters()).toEqual({});
  open('relief.png', 'model', { width_mm: 120, thickness_mm: 8 });
  open('star.svg', 'drawing');
  open('cat.stl', 'model');
  expect(parameters()).toEqual({});
});

it('the second tool’s job comes after the first, and waits until z is set with it', async () => {
  const session = new MachinesSession(testServices(testCatalog(laserJob, millJob)));
  const jobs = ['rough', 'finish'].map((stage) => ({ stage, bytes: new Uint8Array(3) }));
  const toolPath = { bed_mm: [300, 200], no_go_mm: [], seconds: 9, paths: [] } as const;
  session.plan.value = { key: 'lion', report: {}, toolPath, jobs, misfits: [] };
  const ended = (how: string | null) => ({ job: { ended: how, acknowledged: 1 }, can: [] });
  const state = signal(ended(null));
  session.control.link.value = { state, gone: signal(null), command: async () => {} } as never;
  session.control.loaded.value = session.jobKey.value;
  expect(session.needsZ).toBe(false);
  state.value = ended('stopped');
  expect(session.job.value?.stage).toBe('rough');
  state.value = ended('done');
  expect(session.job.value?.stage).toBe('finish');
  expect(session.needsZ).toBe(true);
  await session.control.command({ do: 'set_origin', axes: 'xy' });
  expect(session.needsZ).toBe(true);
  await session.control.command({ do: 'set_origin', axes: 'z' });
  expect(session.needsZ).toBe(false);
  // It is not that job which is done.
  expect(session.control.loaded.value).not.toBe(session.jobKey.value);
});

it('a new project begins with the bed of the machine that is chosen', async () => {
  const number = (value: number) => ({ type: 'number', default: value, 'x-group': 'Machine' });
  const plain = testCatalog(laserJob, millJob);
  const properties = { bed_x_mm: number(400), bed_y_mm: number(400), turn_degrees: { type: 'number' } };
  const operations = plain.operations.map((operation) => ({ ...operation, parameters: { properties } }));
  const services = testServices({ ...plain, operations });
  const session = new MachinesSession(services);
  session.profiles.put({
    ...practiceLaser,
    id: 'w',
    name: 'Workshop',
    parameters: { bed_x_mm: 600, bed_y_mm: 300 },
  });
  expect(session.bed_mm).toEqual([600, 300]);
  expect(session.laserSheet.value).toMatchObject({ laser: 'Workshop', bed_x_mm: 600, bed_y_mm: 300 });
  session.setParameters({ turn_degrees: 90 }, 'Turn');
  expect(session.document.value.parameters).toEqual({ turn_degrees: 90, bed_x_mm: 600, bed_y_mm: 300 });
  services.projects.undo();
  expect(await session.take('star.svg', new Uint8Array(3))).toBe(true);
  expect(session.bed_mm).toEqual([600, 300]);
  // What the project was set to counts, whatever the profile becomes.
  session.profiles.put({ ...session.profiles.current, parameters: { bed_x_mm: 900, bed_y_mm: 900 } });
  expect(session.bed_mm).toEqual([600, 300]);
  // New work is for the machine that is chosen then.
  session.profiles.choose(practiceLaser.id);
  expect(await session.take('cat.svg', new Uint8Array(4))).toBe(true);
  expect(session.bed_mm).toEqual([400, 400]);
  session.profiles.remove('w');
});
