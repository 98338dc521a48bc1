// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import { JobError } from '../../jobs/contract';
import { solveInFull } from './full_solve';
import { resultOf, settled, testCraft, TestRoom } from './test_room';

it('a result whose bytes are gone is previewed, and can be made again', async () => {
  const room = new TestRoom();
  room.take('mesh');
  room.projects.do(testCraft.addResult(resultOf('mesh')));
  room.active.value = true;
  await settled();
  expect(room.shown.value?.kind).toBe('preview');
  expect(room.result.value).toBeNull();
  expect(room.document.value.results).toHaveLength(1); // the bytes may be there again at the next start

  const solving = solveInFull(room);
  room.browser.runs[0]?.finish();
  await solving;
  await settled();
  expect(room.shown.value?.kind).toBe('full');
  expect(room.result.value?.id).toBe(room.document.value.results[0]?.id);
  expect(room.document.value.results).toHaveLength(1);
});

it('a result whose bytes are there is shown without a preview', async () => {
  const room = new TestRoom();
  room.take('mesh');
  const blob = await room.projects.blobs.put(new TextEncoder().encode('ply'));
  const outputs = { 'made.ply': { blob, bytes: 3, media_type: 'application/x-ply' } };
  room.projects.do(testCraft.addResult({ ...resultOf('mesh'), outputs }));
  room.active.value = true;
  await settled();
  expect(room.shown.value?.kind).toBe('full');
  expect(room.result.value?.id).toBe('of mesh');
});

it('a model that is refused does not leave the one before on the page; a value that is refused does', async () => {
  const room = new TestRoom();
  room.active.value = true;
  room.take('mesh');
  await settled();
  expect(room.shown.value?.from).toBe('mesh');
  room.refuses = new JobError({ code: 'invalid_input', where: '', message: 'No.' });
  room.projects.do(testCraft.command({ label: 'Set' }, () => ({ parameters: { size_mm: 3 } })));
  await settled();
  expect(room.shown.value?.from).toBe('mesh');
  room.take('other');
  await settled();
  expect(room.problem.value?.message).toBe('No.');
  expect(room.shown.value).toBeNull();
});
