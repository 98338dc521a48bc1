// @vitest-environment happy-dom
// SPDX-License-Identifier: GPL-3.0-or-later
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { BlobStore } from '../../project/blob_store';
import { ProjectStore } from '../../project/project_store';
import { MemoryStorage } from '../../project/storage';
import { place } from '../route';
import { findControl, nameOf } from './find_control';
import {
  leaveTutorial,
  learning,
  pointedAt,
  sayDone,
  skipStep,
  startTutorial,
  stepBack,
  watchPage,
} from './learning';
import { stepDone } from './step_done';
import type { Tutorial } from './tutorial';
import { button, exactly, field, stepsIn } from './tutorial';

const room = stepsIn('relief');
const tutorial: Tutorial = {
  name: 'two',
  title: 'Two steps',
  makes: 'Nothing.',
  steps: [
    room.press('Press **Solve**.', button('Solve'), [{ strip: 'Relief ready' }]),
    room.enter('Set **Thickness** to 4.', field('Thickness'), '4'),
    room.look('Look.'),
  ],
};
const unseen = { pressed: false, said: false, entered: false };

let projects: ProjectStore;
let stop: () => void;
beforeEach(() => {
  vi.useFakeTimers();
  sessionStorage.clear();
  const storage = new MemoryStorage();
  projects = new ProjectStore(storage, new BlobStore(storage));
  document.body.innerHTML = `
    <button>Solve at full detail<span aria-hidden="true">!</span></button>
    <button aria-label="Solve">icon</button>
    <label for="t">Thickness</label><input id="t" type="text" value="5.0">
    <footer><strong>Preview up to date</strong></footer>`;
  stop = watchPage(projects);
});
afterEach(() => {
  leaveTutorial();
  stop();
  vi.useRealTimers();
});
const tick = () => vi.advanceTimersByTime(300);
const text = (words: string) => ((document.querySelector('footer strong') as Element).textContent = words);
const input = () => document.querySelector('input') as HTMLInputElement;

it('finds a control by the whole of its name before one that begins so, and in an open dialog only', () => {
  expect(findControl(button('Solve'))?.textContent).toBe('icon');
  expect(nameOf(document.querySelectorAll('button')[0] as Element)).toBe('Solve at full detail');
  expect(findControl(button('Solve at'))?.textContent).toContain('full detail');
  expect(findControl(exactly(button('Solve at')))).toBeNull();
  expect(findControl(field('Thickness'))).toBe(input());
  const dialog = document.createElement('dialog');
  dialog.setAttribute('open', '');
  dialog.innerHTML = '<button>Cancel</button>';
  document.body.append(dialog);
  expect(findControl(button('Solve'))).toBeNull();
  expect(findControl(button('Cancel'))).not.toBeNull();
});

it('goes on when the step was done, not before', async () => {
  await startTutorial(tutorial, projects);
  place.value = 'relief';
  tick();
  expect(pointedAt.value?.textContent).toBe('icon');
  text('Relief ready');
  tick();
  expect(learning.value?.step).toBe(0); // ready it was, but nobody pressed
  text('Preview up to date');
  findControl(button('Solve'))?.click();
  tick();
  expect(learning.value?.step).toBe(0); // pressed, and not ready yet
  text('Relief ready');
  tick();
  expect(learning.value?.step).toBe(1);

  input().focus();
  input().value = '4';
  input().dispatchEvent(new Event('input', { bubbles: true }));
  tick();
  expect(learning.value?.step).toBe(1); // it may become 40
  input().dispatchEvent(new KeyboardEvent('keydown', { key: 'Enter', bubbles: true }));
  input().value = '4.0';
  tick();
  expect(learning.value?.step).toBe(2);
  tick();
  sayDone();
  expect(learning.value?.step).toBe(3);
});

it('points to the room where the step is', async () => {
  document.body.insertAdjacentHTML('afterbegin', '<nav><a href="#/relief">Relief</a></nav>');
  await startTutorial(tutorial, projects);
  place.value = 'zippable';
  tick();
  expect(pointedAt.value?.textContent).toBe('Relief');
});

it('changes nothing of the project, is skipped, gone back, left, and ends with another project', async () => {
  const before = projects.document.value;
  await startTutorial(tutorial, projects);
  expect(projects.document.value).toBe(before); // it was empty
  skipStep();
  stepBack();
  skipStep();
  expect(learning.value?.step).toBe(1);
  expect(projects.document.value).toBe(before);
  expect(projects.undoLabel.value).toBeNull();
  const named = { label: 'a', apply: (d: typeof before) => ({ ...d, crafts: { relief: {} } }) };
  projects.do(named);
  await projects.flush();
  const { id } = projects.document.value;
  await startTutorial(tutorial, projects); // begins a project of its own
  expect(projects.document.value.id).not.toBe(id);
  expect(JSON.stringify(projects.document.value)).not.toContain('two');
  tick();
  vi.advanceTimersByTime(10_000);
  await projects.open(id);
  tick();
  expect(learning.value).toBeNull();
});

it('reads a choice from its list', () => {
  document.body.innerHTML =
    '<label for="s">Preset</label><select id="s"><option>Felt</option><option>Card</option></select>';
  const step = room.choose('Choose **Card**.', { role: 'combobox', name: 'Preset' }, 'Card');
  expect(stepDone(step, unseen)).toBe(false);
  (document.querySelector('select') as HTMLSelectElement).selectedIndex = 1;
  expect(stepDone(step, unseen)).toBe(true);
});
