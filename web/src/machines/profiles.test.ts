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
    for (const { id } of [practiceMill, mill]) store.remove(id);
    expect(store.oneThat(true)).toEqual(practiceMill);
  });
  it('one of the other kind is the last that was in use, also in the next page', () => {
    const memory = new Memory();
    const store = new ProfileStore(memory);
    const printer = { ...practiceLaser, id: 'p', name: 'Printer', options: { tool: 'printer' } };
    const mill = { ...practiceMill, id: 'm', name: 'Workshop mill' };
    for (const machine of [mill, laser, printer, practiceMill]) store.put(machine);
    for (const { laser: used } of [store, new ProfileStore(memory)]) expect(used.name).toBe('Workshop');
    store.choose('a');
    expect(store.oneThat(true).name).toBe('Practice mill');
    store.choose('m');
    store.choose('a');
    expect(new ProfileStore(memory).oneThat(true).name).toBe('Workshop mill');
    store.remove('m');
    expect(store.oneThat(true).name).toBe('Practice mill');
    for (const id of ['a', 'practice']) store.remove(id);
    expect(store.laser).toEqual(practiceLaser); // there is always one to practise on
  });
  describe('in two tabs', () => {
    const felt = { name: 'Felt 3 mm', parameters: { cut_power_percent: 45 } };
    const plain = { ...laser, materials: [] };
    it('stay when another tab chooses or adds a machine', () => {
      const memory = new Memory();
      const [one, two] = [new ProfileStore(memory), new ProfileStore(memory)];
      one.put(plain);
      one.put({ ...plain, materials: [felt] });
      two.choose(practiceMill.id);
      two.put({ ...practiceMill, id: 'm', name: 'Workshop mill' });
      expect(two.current.name).toBe('Workshop mill');
      const stored = new ProfileStore(memory);
      expect(stored.profiles.value.map(({ name }) => name)).toEqual([
        'Practice laser',
        'Practice mill',
        'Workshop',
        'Workshop mill',
      ]);
      expect(stored.profiles.value.find(({ id }) => id === 'a')?.materials).toEqual([felt]);
    });
    it('keep what one measured when the other takes the machine up as it knew it', () => {
      const memory = new Memory();
      new ProfileStore(memory).put(plain);
      const [one, two] = [new ProfileStore(memory), new ProfileStore(memory)];
      one.put({ ...plain, materials: [felt] });
      two.put(plain); // as the menu does when it is chosen
      expect(two.current.materials).toEqual([felt]);
      expect(new ProfileStore(memory).current.materials).toEqual([felt]);
    });
    it('are told of each other, and each keeps the one it uses', () => {
      const [memory, tabs] = [new Memory(), new EventTarget()];
      const [one, two] = [new ProfileStore(memory), new ProfileStore(memory, tabs)];
      const notify = () =>
        tabs.dispatchEvent(Object.assign(new Event('storage'), { key: 'formwright.machines' }));
      one.put(laser);
      notify();
      expect(two.profiles.value.map(({ id }) => id)).toContain('a');
      expect(two.current.id).toBe('practice');
      two.choose('a');
      one.remove('a');
      notify();
      expect(one.profiles.value.map(({ id }) => id)).not.toContain('a');
      expect(two.current).toEqual(laser); // a job may be under way on it
    });
    it('are written later where there was no room', () => {
      const memory = new Memory();
      const { setItem } = memory;
      const [one, two] = [new ProfileStore(memory), new ProfileStore(memory)];
      memory.setItem = () => {
        throw new DOMException('full', 'QuotaExceededError');
      };
      one.put(laser);
      one.remove(practiceMill.id);
      memory.setItem = setItem;
      two.choose(practiceLaser.id);
      one.choose('a');
      expect(new ProfileStore(memory).profiles.value.map(({ id }) => id)).toEqual(['practice', 'a']);
    });
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
