// @vitest-environment happy-dom
// SPDX-License-Identifier: GPL-3.0-or-later
import { signal } from '@preact/signals';
import { expect, it } from 'vitest';
import { settled } from '../../shared/session/test_room';
import { followBridge, found } from './bridge_machines';
import type { MachinesSession } from './machines_session';

it('dead print servers are asked two at a time, and hide neither the list nor those that live', async () => {
  const listed = ['a', 'b', 'c', 'd', 'e'].map((id) => ({
    id,
    name: id,
    kind: 'octoprint',
    detail: '',
    state: '',
  }));
  const answers: (() => void)[] = [];
  const worker = {
    json: async (path: string) => {
      if (path === 'machines') return listed;
      await new Promise<void>((resolve) => answers.push(resolve));
      if (path.includes('/e')) return { state: 'printing' };
      throw new Error('It does not answer.');
    },
  };
  const connection = signal({ state: 'ready' });
  const stop = followBridge({ services: { worker, connection } } as unknown as MachinesSession);
  await settled();
  expect(found.value.map(({ id }) => id)).toEqual(['a', 'b', 'c', 'd', 'e']);
  expect(answers).toHaveLength(2);
  for (let k = 0; k < 5; ++k) {
    answers[k]?.();
    await settled();
    expect(answers.length).toBeLessThanOrEqual(k + 3);
  }
  expect(found.value.map(({ state }) => state)).toEqual(['off', 'off', 'off', 'off', 'printing']);
  stop();
});
