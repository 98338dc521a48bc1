// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import { TestRoom } from './test_room';

it('a picture that is drawn late makes nothing of the new project that is open by then', async () => {
  const room = new TestRoom();
  room.take('mesh');
  let draw!: (bytes: ArrayBuffer) => void;
  const drawn = new Promise<ArrayBuffer>((resolve) => (draw = resolve));
  const picture = Object.assign(new Blob(), { arrayBuffer: () => drawn });
  const keeping = room.keepPicture('some', picture);
  await room.projects.create();
  draw(new ArrayBuffer(3));
  await keeping;
  expect(room.projects.isBlank.value).toBe(true);
});
