// SPDX-License-Identifier: GPL-3.0-or-later
// The three phases of forming as one slider, with the moment looked at.
import { useEffect, useRef } from 'preact/hooks';
import type { Json } from '../../jobs/contract';
import { formatFixed, formatNumber, IconButton, withUnit } from '../../ui';
import { figure } from '../../shared/session/report';
import type { Phase } from './film';
import { endOf, fractionAt, timeAt } from './film';
import type { Formed, ThermoformSession } from './thermoform_session';
import { playing } from './views';

const titles: Readonly<Record<string, string>> = { relax: 'Sag', raise: 'Raise', vacuum: 'Vacuum' };

/** What happens in a phase, in a few words. */
function phaseDetail(name: string, { report }: Formed, all: Readonly<Record<string, Json>>): string {
  if (name === 'relax') {
    const sag = figure(report, 'sag_mm');
    return sag === null ? '' : `by ${withUnit(formatNumber(sag, 2), 'mm')}`;
  }
  if (name === 'raise') return withUnit(formatNumber(Number(all['mould_speed_mm_per_s'] ?? 0), 2), 'mm/s');
  const vacuum = withUnit(formatNumber(Number(all['vacuum_kpa'] ?? 0), 2), 'kPa');
  const end = withUnit(formatFixed(figure(report, 'forming_end_s') ?? 0, 1), 's');
  const stopped = { all_touching: `touches everywhere at ${end}`, at_rest: `at rest at ${end}` }[
    String(report['stopped_by'])
  ];
  return [vacuum, stopped].filter(Boolean).join(', ');
}

const seconds = (value: number) => withUnit(formatFixed(value, 1), 's');

export function Timeline({ session }: { session: ThermoformSession }) {
  const track = useRef<HTMLDivElement>(null);
  const shown = session.shown.value;
  const moment = session.moment.value;
  usePlaying(session);
  if (shown === null || moment === null) return null;
  const phases = session.phases.value;
  const time = session.time_s.value;
  const end = endOf(shown.film);
  const go = (to: number) => (session.time_s.value = Math.min(end, Math.max(0, to)));
  const goTo = (event: PointerEvent) => {
    const box = track.current?.getBoundingClientRect();
    if (box) go(timeAt(phases, (event.clientX - box.left) / box.width));
  };
  const key = (event: KeyboardEvent) => {
    const step = event.shiftKey ? end / 10 : end / 50;
    const targets: Record<string, number> = {
      ArrowRight: time + step,
      ArrowUp: time + step,
      ArrowLeft: time - step,
      ArrowDown: time - step,
      PageUp: phases.find(({ end_s }) => end_s > time + 1e-6)?.end_s ?? end,
      PageDown: phases.findLast(({ start_s }) => start_s < time - 1e-6)?.start_s ?? 0,
      Home: 0,
      End: end,
    };
    const to = targets[event.key];
    if (to === undefined || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    event.stopPropagation();
    playing.value = false;
    go(to);
  };
  const contact = `${Math.round(100 * moment.touching_share)} %`;
  const at = 100 * fractionAt(phases, time);
  return (
    <section class="panel timeline" aria-label="Forming">
      <div class="timeline-head">
        <IconButton
          icon={playing.value ? 'pause' : 'play'}
          label={playing.value ? 'Pause' : 'Play'}
          keys="Space"
          onClick={() => togglePlay(session)}
        />
        <strong>{seconds(time)}</strong>
        <span>of {seconds(end)}</span>
        <span class="grow" />
        <span class="timeline-contact">
          In contact <strong>{contact}</strong>
        </span>
      </div>
      <div
        ref={track}
        class="timeline-track"
        role="slider"
        tabIndex={0}
        aria-label="Moment of forming"
        aria-valuemin={0}
        aria-valuemax={Number(end.toFixed(2))}
        aria-valuenow={Number(time.toFixed(2))}
        aria-valuetext={`${seconds(time)} of ${seconds(end)}, ${(titles[moment.phase] ?? moment.phase).toLowerCase()}, ${contact} in contact`}
        onKeyDown={key}
        onPointerDown={(event) => {
          event.currentTarget.setPointerCapture(event.pointerId);
          playing.value = false;
          goTo(event);
        }}
        onPointerMove={(event) => {
          if (event.currentTarget.hasPointerCapture(event.pointerId)) goTo(event);
        }}
      >
        {phases.map((phase) => (
          <PhaseBlock
            key={phase.name}
            phase={phase}
            detail={phaseDetail(phase.name, shown, session.filled(shown.parameters))}
          />
        ))}
        <i class="playhead" style={{ left: `${at}%` }} />
      </div>
      <div class="timeline-ticks" aria-hidden="true">
        <span style={{ left: '0' }}>0</span>
        {phases.map(({ name, to, end_s }) => (
          <span key={name} style={{ left: `${100 * to}%` }}>
            {to === 1 ? seconds(end_s) : formatFixed(end_s, 1)}
          </span>
        ))}
      </div>
    </section>
  );
}

function PhaseBlock({ phase: { name, from, to }, detail }: { phase: Phase; detail: string }) {
  return (
    <div class="phase" style={{ left: `${100 * from}%`, width: `${100 * (to - from)}%` }}>
      <b>{titles[name] ?? name}</b>
      <span>{detail}</span>
    </div>
  );
}

const still = () => matchMedia('(prefers-reduced-motion: reduce)').matches;

/** From the end it begins again. Where motion is unwanted it goes from phase to phase. */
export function togglePlay(session: ThermoformSession): void {
  const shown = session.shown.value;
  if (shown === null) return;
  const end = endOf(shown.film);
  const time = session.time_s.value;
  if (still()) {
    const next = session.phases.value.find(({ end_s }) => end_s > time + 1e-6);
    session.time_s.value = next?.end_s ?? 0;
    return;
  }
  if (!playing.value && time >= end - 1e-6) session.time_s.value = 0;
  playing.value = !playing.value;
}

/** As fast as it was, or as this machine draws. */
function usePlaying(session: ThermoformSession): void {
  const on = playing.value;
  useEffect(() => {
    if (!on) return undefined;
    let last = performance.now();
    let frame = requestAnimationFrame(function step(now: number) {
      const film = session.shown.value?.film;
      const end = film ? endOf(film) : 0;
      // A slow picture slows the film rather than jump.
      const next = session.time_s.value + Math.min(0.1, (now - last) / 1000);
      last = now;
      session.time_s.value = Math.min(end, next);
      if (next >= end) playing.value = false;
      else frame = requestAnimationFrame(step);
    });
    return () => cancelAnimationFrame(frame);
  }, [on]);
}
