// @vitest-environment happy-dom
// SPDX-License-Identifier: GPL-3.0-or-later
import { render } from 'preact';
import { expect, it, vi } from 'vitest';
import { useRoomKeys } from './room_keys';
import { settled, TestRoom } from './test_room';

it('a key that is held acts once, and the browser gets none of it', async () => {
  const [solve, save] = [vi.fn(), vi.fn()];
  const room = new TestRoom();
  const Page = () => {
    useRoomKeys(room, () => ({ solve, save }));
    return null;
  };
  render(<Page />, document.body);
  await settled();
  const press = (key: string, repeat: boolean) => {
    const event = new KeyboardEvent('keydown', {
      key,
      repeat,
      ctrlKey: true,
      bubbles: true,
      cancelable: true,
    });
    document.body.dispatchEvent(event);
    return event.defaultPrevented;
  };
  for (const key of ['Enter', 'e'])
    expect([press(key, false), press(key, true), press(key, true)]).toEqual([true, true, true]);
  expect(solve).toHaveBeenCalledTimes(1);
  expect(save).toHaveBeenCalledTimes(1);
});
