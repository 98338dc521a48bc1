// SPDX-License-Identifier: GPL-3.0-or-later
import { signal } from '@preact/signals';
import { expect, it } from 'vitest';
import type { SaveState } from '../project/project_store';
import { askBeforeLeaving } from './leaving';

it('the browser asks while a project could not be saved, also while that is tried again', () => {
  const saveState = signal<SaveState>({ state: 'saved' });
  const page = new EventTarget();
  askBeforeLeaving({ saveState, isBlank: signal(false), lasts: true }, page);
  const asks = () => !page.dispatchEvent(new Event('beforeunload', { cancelable: true }));
  expect(asks()).toBe(false);
  saveState.value = { state: 'unsaved' };
  expect(asks()).toBe(false);
  saveState.value = { state: 'failed', message: 'full' };
  expect(asks()).toBe(true);
  saveState.value = { state: 'saving' };
  expect(asks()).toBe(true);
  saveState.value = { state: 'saved' };
  expect(asks()).toBe(false);
});

it('the browser asks before work is lost that only this tab has', () => {
  const isBlank = signal(true);
  const page = new EventTarget();
  askBeforeLeaving({ saveState: signal<SaveState>({ state: 'saved' }), isBlank, lasts: false }, page);
  const asks = () => !page.dispatchEvent(new Event('beforeunload', { cancelable: true }));
  expect(asks()).toBe(false);
  isBlank.value = false;
  expect(asks()).toBe(true);
  isBlank.value = true;
  expect(asks()).toBe(false);
});
