// SPDX-License-Identifier: GPL-3.0-or-later
// Which of a plan's jobs comes next, where each tool has one of its own.
import type { ReadonlySignal } from '@preact/signals';
import { computed, effect, signal, untracked } from '@preact/signals';
import type { MachineControl } from '../../machines/machine_control';
import type { Plan } from './make_plan';

export class JobStages {
  readonly #plan: ReadonlySignal<Plan | null>;
  readonly #control: MachineControl;
  /** The job that Start starts, of those that the plan has. */
  readonly stage = signal(0);
  readonly job = computed(() => this.#plan.value?.jobs[this.stage.value] ?? null);
  /** Names the plan and the job of it that the machine holds. */
  readonly jobKey = computed(() => this.#keyOf(this.stage.value));
  /** How often z was set before the tool was changed: it must be set once more. */
  #zSetsBefore = -1;

  constructor(plan: ReadonlySignal<Plan | null>, control: MachineControl) {
    this.#plan = plan;
    this.#control = control;
  }

  startFollowing(): void {
    effect(() => this.#follow());
  }

  #keyOf(stage: number): string | null {
    const plan = this.#plan.value;
    return plan && (plan.jobs.length > 1 ? `${plan.key} job ${stage + 1}` : plan.key);
  }

  /** The next job waits for its tool once the one before it is done. */
  #follow(): void {
    const control = this.#control;
    const jobs = this.#plan.value?.jobs.length ?? 0;
    const loaded = control.loaded.value;
    const done = control.state.value?.job?.ended === 'done';
    untracked(() => {
      if (this.stage.value >= jobs) this.choose(0);
      if (done && loaded !== null && loaded === this.jobKey.value && this.stage.value + 1 < jobs)
        this.choose(this.stage.value + 1);
    });
  }

  choose(stage: number): void {
    if (stage === this.stage.value) return;
    this.stage.value = stage;
    this.#zSetsBefore = this.#control.zSets.value;
  }

  /** A tool of another length stands where it is taken to stand only once z was set with it. */
  get needsZ(): boolean {
    return (this.#plan.value?.jobs.length ?? 0) > 1 && this.#control.zSets.value <= this.#zSetsBefore;
  }
}
