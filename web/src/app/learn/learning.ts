// SPDX-License-Identifier: GPL-3.0-or-later
// The tutorial that a person follows now. It watches the page and touches neither the project nor its steps to undo.
import { batch, signal } from '@preact/signals';
import type { ProjectStore } from '../../project/project_store';
import { go, place } from '../route';
import { findControl } from './find_control';
import type { Seen } from './step_done';
import { stepDone } from './step_done';
import type { Control, Step, Tutorial } from './tutorial';
import { tutorials } from './tutorials';

const interval_ms = 200;
const storageKey = 'formwright.tutorial';

/** `step` is one beyond the last when all are done. */
export interface Learning {
  readonly tutorial: Tutorial;
  readonly step: number;
}

export const learning = signal<Learning | null>(null);
/** What is pointed at: the step's control, or the link to its room; null while neither is to be seen. */
export const pointedAt = signal<HTMLElement | null>(null);
/** Raised whenever the page may have moved what is pointed at. */
export const looked = signal(0);

const nothing: Seen = { pressed: false, said: false, entered: false };
let seen: Seen = nothing;

export const stepNow = (): Step | null => {
  const now = learning.value;
  return now?.tutorial.steps[now.step] ?? null;
};

/** In another room than the step's, which its control may have led to: otherwise the link to that room comes first. */
export const isElsewhere = (step: Step): boolean =>
  step.room !== null && place.value !== step.room && !seen.pressed;

const linkTo = (room: NonNullable<Step['room']>): Control =>
  room === 'start'
    ? { role: 'link', name: 'Formwright, start' }
    : { role: 'link', name: room.charAt(0).toUpperCase() + room.slice(1), exact: true };

const targetOf = (step: Step): Control | null =>
  step.room !== null && isElsewhere(step) ? linkTo(step.room) : step.control;

function turnTo(next: Learning | null): void {
  seen = nothing;
  batch(() => {
    learning.value = next;
    point(); // else the card would first find its place by the control of the step before
  });
  if (next === null) sessionStorage.removeItem(storageKey);
  else sessionStorage.setItem(storageKey, JSON.stringify([next.tutorial.name, next.step]));
}

/** Begins in a project of its own; the one that was open is saved first. */
export async function startTutorial(tutorial: Tutorial, projects: ProjectStore): Promise<void> {
  if (!projects.isBlank.value) await projects.create();
  go('start');
  turnTo({ tutorial, step: 0 });
}

export const leaveTutorial = (): void => turnTo(null);

/** The next step, done or not. */
export function skipStep(): void {
  const now = learning.value;
  if (now) turnTo({ ...now, step: now.step + 1 });
}

export function stepBack(): void {
  const now = learning.value;
  if (now && now.step > 0) turnTo({ ...now, step: now.step - 1 });
}

/** The person says that they have looked. */
export function sayDone(): void {
  seen = { ...seen, said: true };
  look();
}

function point(): void {
  const step = stepNow();
  const target = step && targetOf(step);
  pointedAt.value = target && findControl(target);
}

function look(): void {
  const step = stepNow();
  point();
  ++looked.value;
  if (step && stepDone(step, seen)) skipStep();
}

function isOfStep(event: Event): boolean {
  const step = stepNow();
  const control = step?.control && findControl(step.control);
  return control !== null && control !== undefined && control.contains(event.target as Node);
}

/** Watches while a tutorial runs; ends with another project. Returns what ends the watching. */
export function watchPage(projects: ProjectStore): () => void {
  const [name, step] = storedTutorial();
  const stored = tutorials.find((tutorial) => tutorial.name === name);
  if (stored) turnTo({ tutorial: stored, step });
  let project = projects.document.value.id;
  const check = () => {
    if (learning.value === null) return;
    const { id } = projects.document.value;
    // A sample on the start page begins an empty project: that is a step. One that is opened is the person's own.
    if (id !== project && !projects.isBlank.value && !isYoung(projects)) leaveTutorial();
    project = id;
    look();
  };
  const press = (event: Event) => {
    if (isOfStep(event)) seen = { ...seen, pressed: true };
  };
  const enter = (event: KeyboardEvent) => {
    if (event.key === 'Enter' && isOfStep(event)) seen = { ...seen, entered: true };
  };
  const type = (event: Event) => {
    if (isOfStep(event)) seen = { ...seen, entered: false };
  };
  const move = () => void ++looked.value;
  const timer = setInterval(check, interval_ms);
  document.addEventListener('click', press, true);
  document.addEventListener('keydown', enter, true);
  document.addEventListener('input', type, true);
  document.addEventListener('scroll', move, true);
  addEventListener('resize', move);
  return () => {
    clearInterval(timer);
    document.removeEventListener('click', press, true);
    document.removeEventListener('keydown', enter, true);
    document.removeEventListener('input', type, true);
    document.removeEventListener('scroll', move, true);
    removeEventListener('resize', move);
  };
}

/** Made within the last seconds: by a sample that was just chosen. */
const isYoung = (projects: ProjectStore): boolean =>
  Date.now() / 1000 - projects.document.value.created_unix_s < 5;

function storedTutorial(): readonly [string, number] {
  try {
    const [name, step] = JSON.parse(sessionStorage.getItem(storageKey) ?? '[]') as unknown[];
    return [String(name), Number(step) || 0];
  } catch {
    return ['', 0];
  }
}
