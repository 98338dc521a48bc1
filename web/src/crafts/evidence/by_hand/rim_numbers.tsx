// SPDX-License-Identifier: GPL-3.0-or-later
// Fields for the thickness of the rim, one for each side.
import { Fragment } from 'preact';
import { formatNumber } from '../../../ui';
import { evidence } from '../evidence_document';
import type { EvidenceSession } from '../evidence_session';
import type { ByHand } from './hand_marks';
import { rimProblem } from './rim';

export function RimNumbers({ session, byHand }: { session: EvidenceSession; byHand: ByHand }) {
  const { projects } = session.services;
  const rim = byHand.rim ?? [];
  const [first] = rim;
  if (first === undefined) return null;
  const type = (side: string, typed: string) => {
    const changed = rim.map((reading) => (reading.side === side ? { ...reading, typed } : reading));
    projects.do(evidence.changeByHand({ rim: changed }, `Measure the rim, ${side}`, `rim ${side}`));
  };
  return (
    <fieldset class="hand-rim">
      <legend>
        Thickness of the rim, in the middle of each side, with calipers
        <span>about {formatNumber(first.expected_mm, 3)} mm; leave blank what you cannot measure</span>
      </legend>
      {rim.map((reading) => {
        const problem = rimProblem(reading);
        return (
          <Fragment key={reading.side}>
            <label>
              {reading.side}
              <input
                class="hand-number"
                inputMode="decimal"
                aria-label={`Thickness of the rim, ${reading.side}, in mm`}
                aria-invalid={problem ? 'true' : undefined}
                aria-describedby={problem ? `rim-problem-${reading.side}` : undefined}
                value={reading.typed}
                onInput={(event) => type(reading.side, event.currentTarget.value)}
                onBlur={() => projects.commit()}
              />
            </label>
            {problem ? (
              <span id={`rim-problem-${reading.side}`} class="mark-problem">
                {problem}
              </span>
            ) : null}
          </Fragment>
        );
      })}
    </fieldset>
  );
}
