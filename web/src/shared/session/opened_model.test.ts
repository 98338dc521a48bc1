// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import { settled, TestRoom } from './test_room';

it('a file that was still opening is not opened in the project that is open by then', async () => {
  for (const deaf of [false, true]) {
    const room = new TestRoom();
    room.browser.deaf = deaf; // it may have been read already
    room.take('mesh of the other');
    const other = room.projects.document.value;
    await room.projects.create();
    const opening = room.model.openSample('lion', 'Lion');
    await settled();
    await room.projects.open(other.id);
    room.browser.runs[0]?.finish('model.ply');
    expect(await opening).toBe(false);
    expect(room.browser.runs[0]?.options.signal?.aborted).toBe(true);
    expect(room.projects.document.value).toEqual(other);
    expect(room.activity.value.kind).toBe('idle');
  }
});

it('the same without a change of projects opens and names', async () => {
  const room = new TestRoom();
  const opening = room.model.openSample('lion', 'Lion');
  await settled();
  room.browser.runs[0]?.finish('model.ply');
  expect(await opening).toBe(true);
  expect(room.title).toBe('Lion');
  expect(room.projects.document.value.name).toBe('Lion');
});
