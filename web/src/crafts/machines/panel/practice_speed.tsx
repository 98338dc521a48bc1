// SPDX-License-Identifier: GPL-3.0-or-later
// How fast a practice machine works off a job. Real machines have no such control.
import { useId } from 'preact/hooks';
import { fastest } from '../../../machines/links/practice_clock';
import { Segmented } from '../../../ui';
import type { MachinesSession } from '../machines_session';

const speeds = [
  { value: '1', label: '1×', speed: 1 },
  { value: '4', label: '4×', speed: 4 },
  { value: '16', label: '16×', speed: 16 },
  { value: 'fastest', label: 'Fastest', speed: fastest },
] as const;

export function PracticeSpeed({ session }: { readonly session: MachinesSession }) {
  const { control } = session;
  const id = useId();
  if (control.link.value?.practice === undefined) return null;
  const chosen = speeds.find(({ speed }) => speed === control.practiceSpeed.value);
  return (
    <div class="practice-speed">
      <span id={id}>Speed of practice jobs</span>
      <Segmented
        labelledBy={id}
        describedBy={`${id}-help`}
        options={speeds}
        value={chosen?.value ?? '1'}
        onChange={(value) =>
          (control.practiceSpeed.value = speeds.find((one) => one.value === value)?.speed ?? 1)
        }
      />
      <p id={`${id}-help`} class="hint">
        Job time and log are those of a real machine. Stop, pauses and moves by hand are not sped up.
      </p>
    </div>
  );
}
