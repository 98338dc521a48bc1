// SPDX-License-Identifier: GPL-3.0-or-later
// Marks to measure by hand: where they lie on the flat sheet, what they would show, and the numbers that were read.
import { useSignal } from '@preact/signals';
import { formatNumber, Icon, Segmented, withUnit } from '../../../ui';
import { evidence } from '../evidence_document';
import type { EvidenceSession } from '../evidence_session';
import { Pane } from '../pictures/maps';
import type { ByHand, HandMark, Outlook } from './hand_marks';
import { expectedAt, fromOrigin, outlooksIn, placeOf, problemOf } from './hand_marks';
import { MarksPicture } from './marks_picture';
import { RimNumbers } from './rim_numbers';
import { openingOf, planNow } from './plan_marks';

const axes = ['x', 'y', 'z'] as const;
const origins = [
  { value: 'corner', label: 'Front left corner' },
  { value: 'middle', label: 'Middle' },
] as const;

export function HandPanel({ session, byHand }: { session: EvidenceSession; byHand: ByHand }) {
  const hovered = useSignal<number | null>(null);
  const plan = planNow(session, byHand);
  if (plan === null)
    return (
      <div class="bench">
        <Pane title="Measure by hand" detail="">
          <ol class="hand-steps">
            <li>
              <strong>Choose the marks.</strong> The simulation finds the few places on the sheet that tell
              most about your machine, and says which faults they would show.
            </li>
            <li>
              <strong>Draw them on the sheet</strong> with a ruler, or transfer the printed drawing, before
              the sheet is formed.
            </li>
            <li>
              <strong>Form the sheet</strong> as always.
            </li>
            <li>
              <strong>Measure each mark</strong> with calipers and a depth gauge, while the sheet is still
              clamped if you can, and how thick its rim is. Type the numbers here.
            </li>
          </ol>
        </Pane>
      </div>
    );
  return (
    <div class="bench">
      <div class="hand-panes">
        <Pane title="Marks on the flat sheet" detail="seen from above">
          <MarksPicture byHand={byHand} report={plan.report} hovered={hovered} />
        </Pane>
        <Pane title="What these marks show" detail="before anything is measured">
          <Outlooks outlooks={outlooksIn(plan.report)} />
        </Pane>
      </div>
      <Pane title="Measured" detail="millimetres">
        <Numbers session={session} byHand={byHand} onHover={(mark) => (hovered.value = mark)} />
        <RimNumbers session={session} byHand={byHand} />
      </Pane>
    </div>
  );
}

const strength = (value: number, unit: string): string =>
  unit === '' ? formatNumber(value, 2) : withUnit(formatNumber(value, 2), unit);

function Outlooks({ outlooks }: { outlooks: readonly Outlook[] }) {
  return (
    <div class="hand-table">
      <table class="outlooks">
        <thead>
          <tr>
            <th scope="col">Cause</th>
            <th scope="col">shows from</th>
            <th scope="col">usual</th>
          </tr>
        </thead>
        <tbody>
          {outlooks.map(({ name, label, unit, shows, usual, visibleFrom }) => (
            <tr key={name} class={shows ? 'shows' : ''}>
              <th scope="row">
                {shows ? <Icon name="check" small /> : <span class="no-icon" />}
                {label}
                <span class="hidden-text">{shows ? ': shows at usual strength' : ': hardly shows'}</span>
              </th>
              <td>{visibleFrom === null ? 'never' : strength(visibleFrom, unit)}</td>
              <td>{strength(usual, unit)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

interface NumbersProps {
  readonly session: EvidenceSession;
  readonly byHand: ByHand;
  readonly onHover: (mark: number | null) => void;
}

function Numbers({ session, byHand, onHover }: NumbersProps) {
  const { projects } = session.services;
  const { marks, origin } = byHand;
  const opening = openingOf(byHand);
  const type = (which: number, axis: number, text: string) => {
    const changed = marks.map((mark, i): HandMark => {
      if (i !== which) return mark;
      const [x, y, z] = mark.typed.map((old, k) => (k === axis ? text : old));
      return { ...mark, typed: [x ?? '', y ?? '', z ?? ''] };
    });
    const label = `Measure mark ${which + 1}`;
    projects.do(evidence.changeByHand({ marks: changed }, label, `mark ${which} ${axis}`));
  };
  const setOrigin = (next: typeof origin) => {
    const moved = fromOrigin(marks, origin, next, opening);
    projects.do(evidence.changeByHand({ origin: next, marks: moved }, 'Change where x and y begin'));
    projects.commit();
  };
  return (
    <>
      <div class="row hand-origin">
        <span>x and y from the clamp opening’s</span>
        <Segmented
          label="x and y from the clamp opening’s"
          options={origins}
          value={origin}
          onChange={setOrigin}
        />
        <span>z from the raised base plate</span>
      </div>
      <div class="hand-table">
        <table class="hand-numbers">
          <thead>
            <tr>
              <th scope="col">Mark</th>
              <th scope="col">on the sheet</th>
              <th scope="col">expected</th>
              {axes.map((axis) => (
                <th scope="col" key={axis}>
                  {axis}
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {marks.map((mark, i) => {
              const problem = problemOf(mark, origin, opening);
              const expected = expectedAt(mark, origin, opening);
              return (
                <tr
                  key={mark.sheet_mm.join()}
                  class={placeOf(mark, origin, opening) ? 'done' : ''}
                  onPointerEnter={() => onHover(i)}
                  onPointerLeave={() => onHover(null)}
                  onFocusIn={() => onHover(i)}
                  onFocusOut={() => onHover(null)}
                >
                  <th scope="row">{i + 1}</th>
                  <td>{mark.sheet_mm.map((at) => String(at).replace('-', '\u2212')).join(', ')}</td>
                  <td>{expected.map((at) => at.toFixed(1).replace('-', '\u2212')).join(', ')}</td>
                  {axes.map((axis, k) => (
                    <td key={axis}>
                      <input
                        class="hand-number"
                        inputMode="decimal"
                        aria-label={`Mark ${i + 1}, ${axis} in mm`}
                        aria-invalid={problem !== '' && mark.typed[k]?.trim() !== '' ? 'true' : undefined}
                        aria-describedby={problem ? `mark-problem-${i}` : undefined}
                        value={mark.typed[k] ?? ''}
                        onInput={(event) => type(i, k, event.currentTarget.value)}
                        onBlur={() => projects.commit()}
                      />
                    </td>
                  ))}
                  {problem ? (
                    <td id={`mark-problem-${i}`} class="mark-problem">
                      {problem}
                    </td>
                  ) : null}
                </tr>
              );
            })}
          </tbody>
        </table>
      </div>
    </>
  );
}
