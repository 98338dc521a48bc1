// SPDX-License-Identifier: GPL-3.0-or-later
// Bends the ribbon in space from flat to zipped, by hand or by itself.
import { useEffect } from 'preact/hooks';
import { Button, IconButton, Segmented } from '../../../ui';
import { simulationBytes } from '../make_product';
import { bend, course, playing } from '../views';
import { simulating } from '../zippable_document';
import type { ZippableSession } from '../zippable_session';

const duration_s = 4;

export function togglePlay(): void {
  if (!playing.value && bend.value >= 1) bend.value = 0;
  playing.value = !playing.value;
}

export interface PlayProps {
  readonly session: ZippableSession;
  /** Flat, the ribbon is larger than zipped: the picture follows. */
  readonly onFit: () => void;
}

export function Play({ session, onFit }: PlayProps) {
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
  const simulated = session.simulation.value;
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
          aria-label="From flat to zipped"
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
        {simulated && course.value === 'simulated' ? (
          <p>{String(simulated.report['verdict'] ?? '')}</p>
        ) : (
          <p>Animation only: lengths are kept, but forces are not simulated.</p>
        )}
        <Choice session={session} />
      </div>
    </section>
  );
}

const courses = [
  { value: 'drawn', label: 'Geometry only' },
  { value: 'simulated', label: 'Simulated cloth' },
] as const;

/** Both courses once cloth was simulated; before that, what does it. */
function Choice({ session }: { session: ZippableSession }) {
  if (session.operationNamed(simulating) === undefined) return null;
  if (session.simulation.value)
    return (
      <Segmented
        label="Animation"
        options={courses}
        value={course.value}
        onChange={(value) => (course.value = value)}
      />
    );
  const idle = session.activity.value.kind === 'idle';
  const reason =
    session.result.value === null
      ? 'Make the ribbon first'
      : idle
        ? undefined
        : 'A file is being made or opened';
  const simulate = async () => {
    course.value = 'simulated';
    await simulationBytes(session, 'zipping.glb', 'simulation');
  };
  return (
    <Button size="small" icon="zippable" disabledReason={reason} onClick={() => void simulate()}>
      Will it zip? Simulate cloth
    </Button>
  );
}
