// SPDX-License-Identifier: GPL-3.0-or-later
// The flat sheet with its numbered marks, as the printed drawing has it.
import type { Signal } from '@preact/signals';
import type { Report } from '../../../jobs/contract';
import type { ByHand } from './hand_marks';
import { pairIn, placeOf } from './hand_marks';
import { openingOf } from './plan_marks';

const cross_mm = 4;

interface MarksPictureProps {
  readonly byHand: ByHand;
  readonly report: Report;
  readonly hovered: Signal<number | null>;
}

export function MarksPicture({ byHand, report, hovered }: MarksPictureProps) {
  const opening = openingOf(byHand);
  const [width, length] = pairIn(report, 'sheet_mm') ?? opening;
  const { marks, origin } = byHand;
  const measured = marks.filter((mark) => placeOf(mark, origin, opening) !== null).length;
  return (
    <svg
      class="marks-picture"
      viewBox={`${-width / 2 - 4} ${-length / 2 - 4} ${width + 8} ${length + 14}`}
      role="img"
      aria-label={`${marks.length} numbered marks on the flat sheet, ${measured} of them measured`}
    >
      <rect class="marks-sheet" x={-width / 2} y={-length / 2} width={width} height={length} rx="2" />
      <rect
        class="marks-opening"
        x={-opening[0] / 2}
        y={-opening[1] / 2}
        width={opening[0]}
        height={opening[1]}
      />
      <path class="marks-middle" d={`M${-width / 2} 0H${width / 2}M0 ${-length / 2}V${length / 2}`} />
      {marks.map((mark, i) => {
        const [x, y] = [mark.sheet_mm[0], -mark.sheet_mm[1]];
        const done = placeOf(mark, origin, opening) !== null;
        const state = `${done ? 'done' : ''} ${hovered.value === i ? 'hovered' : ''}`;
        return (
          <g key={mark.sheet_mm.join()} class={`marks-mark ${state}`} transform={`translate(${x} ${y})`}>
            <circle r="7" />
            <path d={`M${-cross_mm} 0H${cross_mm}M0 ${-cross_mm}V${cross_mm}`} />
            <text x="5" y="-4">
              {i + 1}
            </text>
          </g>
        );
      })}
      {(byHand.rim ?? []).map(({ side, sheet_mm: [x, y], typed }) => (
        <circle key={side} class={`marks-rim ${typed ? 'done' : ''}`} cx={x} cy={-y} r="3" />
      ))}
      <text class="marks-front" x="0" y={length / 2 + 8}>
        front
      </text>
    </svg>
  );
}
