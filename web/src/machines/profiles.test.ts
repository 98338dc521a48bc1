// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { asProfile, practiceLaser, practiceMill, profileFile, ProfileStore } from './profiles';

class Memory {
  readonly values = new Map<string, string>();
  getItem = (key: string) => this.values.get(key) ?? null;
  setItem = (key: string, value: string) => void this.values.set(key, value);
}
const laser = {
  ...practiceLaser,
  id: 'a',
  name: 'Workshop',
  parameters: { bed_x_mm: 600 },
  materials: [{ name: 'Felt 3 mm', parameters: { cut_power_percent: 45 } }],
};

describe('machine profiles', () => {
  it('come back as they were, from a file and from storage', () => {
    expect(asProfile(JSON.parse(profileFile(laser)))).toEqual(laser);
    const memory = new Memory();
    const store = new ProfileStore(memory);
    expect(store.current.name).toBe('Practice laser');
    store.put(laser);
    const again = new ProfileStore(memory);
    expect(again.current).toEqual(laser);
    again.remove('a');
    expect(new ProfileStore(memory).current.id).toBe('practice');
  });
  it('one that carves and one that does not: the one in use first', () => {
    const store = new ProfileStore(new Memory());
    const mill = { ...practiceMill, id: 'm', name: 'Workshop mill' };
    store.put(mill);
    expect(store.oneThat(true).name).toBe('Workshop mill');
    expect(store.oneThat(false).name).toBe('Practice laser');
    store.put(laser);
    expect(store.oneThat(false).name).toBe('Workshop');
    expect(store.oneThat(true).name).toBe('Practice mill');
    for (const { id } of [practiceMill, mill]) store.remove(id);
    expect(store.oneThat(true)).toEqual(practiceMill);
  });
  it('survive damaged storage', () => {
    const memory = new Memory();
    memory.setItem(
      'formwright.machines',
      '{"profiles":[{"format":"formwright-machine","version":1,"name":""}],"chosen":5}',
    );
    expect(new ProfileStore(memory).current).toEqual(practiceLaser);
    memory.setItem('formwright.machines', 'not json');
    expect(new ProfileStore(memory).current).toEqual(practiceLaser);
  });
  it.each([
    [{}, /not a machine profile/],
    [{ format: 'formwright-machine', version: 2 }, /newer/],
    [{ format: 'formwright-machine', version: 1, name: 'x'.repeat(90) }, /name/],
    [{ format: 'formwright-machine', version: 1, name: 'x', options: { a: { b: 1 } } }, /options/],
    [
      { format: 'formwright-machine', version: 1, name: 'x', options: {}, parameters: {}, materials: [{}] },
      /material name/,
    ],
  ])('refuse %j', (value, sentence) => {
    expect(() => asProfile(value)).toThrow(sentence);
  });
});
