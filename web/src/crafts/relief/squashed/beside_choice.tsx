// SPDX-License-Identifier: GPL-3.0-or-later
// What the swipe shows beside the relief.
import { Icon, Segmented } from '../../../ui';
import type { SquashedRelief } from './squashed_relief';
import './beside_choice.css';

export function BesideChoice({ squashed }: { readonly squashed: SquashedRelief }) {
  return (
    <div class="beside-choice">
      <Segmented
        floating
        label="Beside the relief"
        options={[
          { value: 'model', label: 'Model' },
          { value: 'squashed', label: 'Squashed model' },
        ]}
        value={squashed.wanted.value ? 'squashed' : 'model'}
        onChange={(value) => (squashed.wanted.value = value === 'squashed')}
      />
      <p aria-live="polite">
        {squashed.wanted.value && squashed.problem.value ? (
          <span class="label-chip">{squashed.problem.value}</span>
        ) : squashed.running.value && squashed.made.value === null ? (
          <span class="label-chip">
            <Icon name="clock" small /> Squashing the model
          </span>
        ) : null}
      </p>
    </div>
  );
}
