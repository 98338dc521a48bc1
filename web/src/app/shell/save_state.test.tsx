// @vitest-environment happy-dom
// SPDX-License-Identifier: GPL-3.0-or-later
import { readFileSync } from 'node:fs';
import { render } from 'preact';
import { beforeEach, expect, it } from 'vitest';
import { BlobStore } from '../../project/blob_store';
import { ProjectStore } from '../../project/project_store';
import { MemoryStorage } from '../../project/storage';
import { SaveState } from './save_state';

const settle = () => new Promise((resolve) => setTimeout(resolve, 30));
const button = (words: string) =>
  [...document.querySelectorAll('button')].find(({ textContent }) => textContent?.trim() === words);

class FullStorage extends MemoryStorage {
  override readonly kind = 'opfs';
  full = false;
  override async writeProject(id: string, value: object): Promise<void> {
    if (this.full) throw new DOMException('full', 'QuotaExceededError');
    await super.writeProject(id, value);
  }
  override async deleteProject(id: string): Promise<void> {
    await super.deleteProject(id);
    this.full = false;
  }
}

let storage: FullStorage;
let projects: ProjectStore;
async function work(name: string) {
  projects.do({ label: 'a', apply: (d) => ({ ...d, name, crafts: { relief: {} } }) });
  await projects.flush();
}
beforeEach(async () => {
  const sheets = ['shell', 'narrow'].map((name) =>
    readFileSync(`${import.meta.dirname}/../styles/${name}.css`, 'utf8'),
  );
  document.head.innerHTML = `<style>${sheets.join('\n')}</style>`;
  document.body.innerHTML = '<div class="top"></div>';
  storage = new FullStorage();
  projects = new ProjectStore(storage, new BlobStore(storage));
  await work('Lion');
  await projects.create();
  storage.full = true;
  await work('Bust');
  render(<SaveState projects={projects} />, document.querySelector('.top') as Element);
});

it('a failure is a button, also on a phone, and a success says so where there is room', async () => {
  const display = () => getComputedStyle(document.querySelector('.saved') as Element).display;
  (window as unknown as { happyDOM: { setViewport(size: object): void } }).happyDOM.setViewport({
    width: 390,
  });
  expect(display()).not.toBe('none');
  expect(document.querySelector('[role=status]')?.textContent).toBe('Not saved');
  button('Not saved')?.focus();
  expect(document.activeElement?.textContent).toBe('Not saved');
  storage.full = false;
  await projects.flush();
  await settle();
  expect(document.querySelector('[role=status]')?.textContent).toBe('Saved');
  expect(display()).toBe('none');
});

it('it gives the reason, and the way out: room is made, and the project saved', async () => {
  button('Not saved')?.click();
  await settle();
  expect(document.querySelector('dialog')?.textContent).toMatch(/no room left/);
  button('Try again')?.click();
  await settle();
  expect(document.querySelector('dialog')?.textContent).toMatch(/no room left/);
  button('Delete Lion')?.click();
  await settle();
  expect(projects.projects.value).toHaveLength(1);
  button('Delete')?.click();
  await settle();
  expect(projects.saveState.value.state).toBe('saved');
  expect(projects.projects.value.map(({ name }) => name)).toEqual(['Bust']);
  expect(document.querySelector('dialog')).toBeNull();
});

it('what only the tab has is not called saved, and can be saved as a file', async () => {
  const memory = new MemoryStorage();
  projects = new ProjectStore(memory, new BlobStore(memory));
  await work('Vase');
  document.body.innerHTML = '<div class="top"></div>';
  render(<SaveState projects={projects} />, document.querySelector('.top') as Element);
  expect(projects.saveState.value.state).toBe('saved');
  expect(document.querySelector('.top')?.textContent).toBe('In this tab only');
  button('In this tab only')?.click();
  await settle();
  expect(document.querySelector('dialog')?.textContent).toMatch(/until the tab is closed/);
  expect(button('Save as a file')).toBeDefined();
});
