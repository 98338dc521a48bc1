// @vitest-environment happy-dom
// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, test, vi } from 'vitest';
import type { MachineLink } from './links/machine_link';
import { listenForStop } from './stop_keys';

function listening({ connected = true, busy = true } = {}) {
  const command = vi.fn(() => Promise.resolve(true));
  const target = new EventTarget();
  const control = {
    link: { value: connected ? ({} as MachineLink) : null },
    can: () => busy,
    isBusy: busy,
    command,
  };
  const end = listenForStop(control, target);
  const press = (key: string, timeStamp: number, more: KeyboardEventInit = {}) => {
    const event = new KeyboardEvent('keydown', { key, ...more });
    Object.defineProperty(event, 'timeStamp', { value: timeStamp });
    target.dispatchEvent(event);
  };
  return { command, press, end };
}

test('Esc holds, and again soon after stops', () => {
  const { command, press } = listening();
  press('Escape', 1000);
  press('Escape', 1500);
  expect(command.mock.calls).toEqual([[{ do: 'pause' }], [{ do: 'stop' }]]);
});

test('Esc twice in a long while holds twice; a key held down counts once', () => {
  const { command, press } = listening();
  press('Escape', 1000);
  press('Escape', 1030, { repeat: true });
  press('Escape', 5000);
  expect(command.mock.calls).toEqual([[{ do: 'pause' }], [{ do: 'pause' }]]);
});

test('Ctrl and a full stop stops, busy or not; nothing is sent without a machine', () => {
  const { command, press } = listening({ busy: false });
  press('Escape', 1000);
  press('Escape', 1200);
  expect(command).not.toHaveBeenCalled();
  press('.', 2000, { ctrlKey: true });
  expect(command.mock.calls).toEqual([[{ do: 'stop' }]]);
  const none = listening({ connected: false });
  none.press('.', 1000, { ctrlKey: true });
  expect(none.command).not.toHaveBeenCalled();
});
