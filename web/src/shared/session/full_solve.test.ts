// SPDX-License-Identifier: GPL-3.0-or-later
import { effect } from '@preact/signals';
import { beforeEach, describe, expect, it } from 'vitest';
import { leaving } from '../../jobs/backend';
import { cancelled, JobError } from '../../jobs/contract';
import { requestKey } from './craft_document';
import { outputOf, resumePending, solveInFull } from './full_solve';
import { readyState, settled, testCraft, TestRoom } from './test_room';

let room: TestRoom;
/** With a model each; the first one is open. */
let first: string;
let second: string;

beforeEach(async () => {
  room = new TestRoom();
  room.take('mesh of the second');
  second = room.projects.document.value.id;
  await room.projects.create();
  room.take('mesh of the first');
  first = room.projects.document.value.id;
});
const run = (backend: 'browser' | 'native', index: number) => {
  const found = room[backend].runs[index];
  if (found === undefined) throw new Error('No such run.');
  return found;
};
const lost = new JobError({ code: 'unreachable', where: '', message: 'Gone.' });

describe('a solve in the browser', () => {
  it('ends where another project is opened, and is not written into that one', async () => {
    const own = { job: 'own', mesh: 'x', parameters: {} };
    await room.projects.open(second);
    room.projects.do(testCraft.setPending(own));
    await room.projects.open(first);
    for (const deaf of [false, true]) {
      room.browser.deaf = deaf; // it may have been done already
      const solving = solveInFull(room);
      const { options, finish } = run('browser', Number(deaf));
      await room.projects.open(second);
      expect(options.signal?.aborted).toBe(true);
      expect(room.activity.value.kind).toBe('idle');
      finish();
      await solving;
      expect(room.document.value).toMatchObject({ results: [], pending: own });
      await room.projects.open(first);
      expect(room.document.value.results).toEqual([]);
    }
  });

  it('that fails when another project is open says nothing there', async () => {
    room.browser.deaf = true;
    const solving = solveInFull(room);
    await room.projects.open(second);
    run('browser', 0).fail(new JobError({ code: 'could_not_solve', where: '', message: 'Too thin.' }));
    await solving;
    expect(room.problem.value).toBeNull();
  });

  it('goes on where it is asked for once more, and its result comes', async () => {
    const solving = solveInFull(room);
    await solveInFull(room);
    expect(room.browser.runs).toHaveLength(1);
    expect(run('browser', 0).options.signal?.aborted).toBe(false);
    run('browser', 0).finish();
    await solving;
    expect(room.result.value).not.toBeNull();
  });

  it('is not kept from running by a preview', async () => {
    room.previews.running.value = true;
    void solveInFull(room);
    expect(room.browser.runs).toHaveLength(1);
  });

  it('that ends late leaves the next one its request', async () => {
    room.browser.deaf = true;
    const late = solveInFull(room);
    await room.projects.open(second);
    void solveInFull(room);
    run('browser', 0).finish();
    await late;
    expect(room.solvingFor).toEqual(requestKey('mesh of the second', {}));
  });
});

it('another format is not kept with the project that is open when it is made', async () => {
  const solving = solveInFull(room);
  run('browser', 0).finish();
  await solving;
  room.browser.deaf = true;
  const making = outputOf(room, 'made.stl', 'STL');
  await settled();
  await room.projects.create();
  run('browser', 1).finish('made.stl');
  expect(await making).toBeNull();
  expect(room.projects.isBlank.value).toBe(true);
});

describe('a solve in the worker', () => {
  beforeEach(() => {
    room.connection.value = readyState;
    effect(() => resumePending(room));
  });

  it('goes on where another project is opened; its own one finds it again', async () => {
    const solving = solveInFull(room);
    await room.projects.open(second);
    await solving;
    expect(run('native', 0).options.signal?.reason).toBe(leaving);
    expect(room.document.value).toMatchObject({ results: [], pending: null });
    await room.projects.open(first);
    expect(run('native', 1).asked).toBe('job0');
    run('native', 1).finish();
    await settled();
    expect(room.document.value).toMatchObject({ results: [{ job: 'job0' }], pending: null });
  });

  it('is waited for again though the first waiting ends only then', async () => {
    room.native.deaf = true;
    const solving = solveInFull(room);
    await room.projects.open(second);
    await room.projects.open(first);
    run('native', 0).finish();
    await solving;
    expect(room.activity.value.kind).toBe('solving');
    expect(room.document.value).toMatchObject({ results: [], pending: { job: 'job0' } });
  });

  it('goes on where a room that is looked at follows the change first', async () => {
    room.active.value = true;
    const solving = solveInFull(room);
    await room.projects.open(second);
    await solving;
    expect(run('native', 0).options.signal?.reason).toBe(leaving);
  });

  it('that was cancelled takes nothing from the project that is open when it ends', async () => {
    room.native.deaf = true;
    const solving = solveInFull(room);
    room.cancel();
    room.connection.value = null;
    await room.projects.open(second);
    room.projects.do(testCraft.setPending({ job: 'own', mesh: 'x', parameters: {} }));
    run('native', 0).fail(cancelled());
    await solving;
    expect(room.document.value.pending?.job).toBe('own');
  });

  it('stays pending where the worker is out of reach, and is said', async () => {
    const solving = solveInFull(room);
    room.connection.value = { state: 'refused', message: 'Gone.' };
    run('native', 0).fail(lost);
    await solving;
    expect(room.activity.value.kind).toBe('idle');
    expect(room.problem.value?.message).toBe('Gone.');
    expect(room.document.value.pending?.job).toBe('job0');
  });

  it('says what failed in the notes, whatever field it names', async () => {
    const error = { code: 'could_not_solve', where: 'thickness_mm', message: 'Too thin.' } as const;
    const solving = solveInFull(room);
    run('native', 0).fail(new JobError(error));
    await solving;
    expect(room.problem.value?.message).toBe('Too thin.');
  });

  it('is forgotten where it failed or was cancelled', async () => {
    const failing = solveInFull(room);
    run('native', 0).fail(new JobError({ code: 'could_not_solve', where: '', message: 'Too thin.' }));
    await failing;
    expect(room.document.value.pending).toBeNull();
    const solving = solveInFull(room);
    expect(room.document.value.pending?.job).toBe('job1');
    room.cancel();
    await solving;
    expect(run('native', 1).options.signal?.reason).not.toBe(leaving);
    expect(room.document.value.pending).toBeNull();
  });
});
