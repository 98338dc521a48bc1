// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import { BlobStore } from '../project/blob_store';
import { ProjectStore } from '../project/project_store';
import { MemoryStorage } from '../project/storage';
import { lastProject, rememberProject } from './last_project';

class Memory {
  readonly values = new Map<string, string>();
  getItem = (key: string) => this.values.get(key) ?? null;
  setItem = (key: string, value: string) => void this.values.set(key, value);
}
function tabOf(browser: Memory) {
  const storage = new MemoryStorage();
  const projects = new ProjectStore(storage, new BlobStore(storage));
  const own = new Memory();
  rememberProject(projects, own, browser);
  const work = () => projects.do({ label: 'a', apply: (d) => ({ ...d, crafts: { relief: {} } }) });
  return { projects, own, work, id: () => projects.document.value.id };
}

it('a tab comes back to its own project, a new one to the last that was worked on', () => {
  const browser = new Memory();
  const [one, two] = [tabOf(browser), tabOf(browser)];
  expect(lastProject(new Memory(), browser)).toBeNull();
  one.work();
  expect(lastProject(new Memory(), browser)).toBe(one.id());
  two.work();
  expect(lastProject(one.own, browser)).toBe(one.id());
  expect(lastProject(two.own, browser)).toBe(two.id());
  expect(lastProject(new Memory(), browser)).toBe(two.id());
});

it('an empty project is come back to in its tab only', async () => {
  const browser = new Memory();
  const one = tabOf(browser);
  one.work();
  const worked = one.id();
  const two = tabOf(browser);
  expect(lastProject(two.own, browser)).toBe(two.id());
  expect(lastProject(new Memory(), browser)).toBe(worked);
});
