// SPDX-License-Identifier: GPL-3.0-or-later
// Bends the ribbon in space from flat to zipped, by hand or by itself.
import { useEffect } from 'preact/hooks';
import { IconButton } from '../../ui';
import { bend, playing } from './views';

const duration_s = 4;

export function togglePlay(): void {
  if (!playing.value && bend.value >= 1) bend.value = 0;
  playing.value = !playing.value;
}

export interface PlayProps {
  /** Flat, the ribbon is larger than zipped: the picture follows. */
  readonly onFit: () => void;
}

export function Play({ onFit }: PlayProps) {
  useEffect(() => {
    if (!playing.value) return undefined;
    let frame = 0;
    let before: number | null = null;
    const step = (now: number) => {
      const passed_s = before === null ? 0 : (now - before) / 1000;
      before = now;
      bend.value = Math.min(1, bend.value + passed_s / duration_s);
      onFit();
      if (bend.value >= 1) playing.value = false;
      else frame = requestAnimationFrame(step);
    };
    frame = requestAnimationFrame(step);
    return () => cancelAnimationFrame(frame);
  }, [playing.value]);
  useEffect(
    () => () => {
      playing.value = false;
    },
    [],
  );
  const percent = Math.round(100 * bend.value);
  return (
    <section class="panel play" aria-label="Zipping up">
      <IconButton
        icon={playing.value ? 'pause' : 'play'}
        label={playing.value ? 'Pause' : 'Play'}
        keys="Space"
        onClick={togglePlay}
      />
      <div class="grow">
        <input
          type="range"
          aria-label="How far it is bent"
          aria-valuetext={`${percent} % of the way from flat to zipped`}
          min={0}
          max={1}
          step={0.01}
          value={bend.value}
          style={{ '--filled': `${percent}%` }}
          onInput={(event) => {
            playing.value = false;
            bend.value = Number(event.currentTarget.value);
            onFit();
          }}
        />
        <p>Animation: edges keep their lengths. Not a simulation.</p>
      </div>
    </section>
  );
}
