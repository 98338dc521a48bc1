// SPDX-License-Identifier: GPL-3.0-or-later
// How like its model the relief looks in the course of the day.
import type { DayOfLight } from './light_values';
import { clock, daySentence } from './light_values';

const width = 288;
const height = 84;
const foot = 14;
const hours = 24;

export interface DayCurveProps {
  readonly day: DayOfLight;
  readonly hour: number;
  readonly onHour: (hour: number) => void;
}

/** A press sets the hour; keys have the field of the hour and the buttons below. */
export function DayCurve({ day, hour, onHour }: DayCurveProps) {
  const known = day.hours.flatMap(({ similarity }) => (similarity === null ? [] : [similarity]));
  const high = Math.max(0.05, ...known);
  const low = Math.min(0, ...known);
  const x = (at: number) => (at / hours) * width;
  const y = (similarity: number) => 6 + (1 - (similarity - low) / (high - low)) * (height - foot - 10);
  const best = day.hours.find((one) => one.hour === day.best);
  return (
    <>
      <svg
        class="day-curve"
        viewBox={`0 0 ${width} ${height}`}
        role="img"
        aria-label={daySentence(day)}
        onClick={(event) => {
          const { left, width: wide } = event.currentTarget.getBoundingClientRect();
          const pressed = ((event.clientX - left) / wide) * hours;
          onHour(Math.min(23.5, Math.max(0, Math.round(pressed * 2) / 2)));
        }}
      >
        {day.hours.map((one) =>
          one.sunOnWall ? (
            <rect class="in-sun" x={x(one.hour - 0.25)} y={0} width={x(0.5)} height={height - foot} />
          ) : null,
        )}
        <path class="likeness" d={linesThrough(day, x, y)} />
        <line class="now" x1={x(hour)} x2={x(hour)} y1={0} y2={height - foot} />
        {best && best.similarity !== null ? (
          <circle class="best" cx={x(best.hour)} cy={y(best.similarity)} r={4} />
        ) : null}
        {[0, 6, 12, 18, 24].map((tick) => (
          <text
            x={x(tick)}
            y={height - 2}
            text-anchor={tick === 0 ? 'start' : tick === 24 ? 'end' : 'middle'}
          >
            {clock(tick)}
          </text>
        ))}
      </svg>
      <p class="day-words" aria-hidden="true">
        {daySentence(day)}
      </p>
    </>
  );
}

/** Hours without light interrupt it, and so do the sun's coming and going. */
function linesThrough({ hours: all }: DayOfLight, x: (hour: number) => number, y: (value: number) => number) {
  return all
    .map(({ hour, similarity, sunOnWall }, i) => {
      const before = all[i - 1];
      if (similarity === null) return '';
      const joined = before !== undefined && before.similarity !== null && before.sunOnWall === sunOnWall;
      return `${joined ? 'L' : 'M'}${x(hour).toFixed(1)} ${y(similarity).toFixed(1)}`;
    })
    .join('');
}
