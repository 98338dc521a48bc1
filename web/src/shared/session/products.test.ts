// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import { productBytes } from './products';
import { settled, testCatalog, TestRoom } from './test_room';

it('what was made of one project’s sheet is not kept with the project that is open by then', async () => {
  const [operation] = testCatalog('moulding').operations;
  if (operation === undefined) throw new Error('No operation.');
  const request = { operation, from: 'sheet', inputs: {}, output: 'made.ply', beside: [], label: 'mould' };
  for (const switches of [false, true]) {
    const room = new TestRoom();
    room.browser.deaf = true; // it was all but done
    room.take('mesh');
    const making = productBytes(room, request);
    await settled();
    if (switches) await room.projects.create();
    room.browser.runs[0]?.finish();
    expect((await making) === null).toBe(switches);
    expect(room.projects.isBlank.value).toBe(switches);
    expect(room.document.value.products).toHaveLength(switches ? 0 : 1);
  }
});
