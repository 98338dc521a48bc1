// SPDX-License-Identifier: GPL-3.0-or-later
// The parts by number: how many windings each got, how distorted it is, and what speaks against it.
import { Fragment } from 'preact';
import { Button, formatFixed, formatNumber, Icon, Parameter, withUnit } from '../../../ui';
import { sentences } from '../../../shared/session/report';
import { partName } from '../design';
import { ownWindings, withOwnWindings } from './own_windings';
import { partWarning, unwrapWords } from './part_notes';
import { tool } from './draw_actions';
import { drawnOn } from '../zippable_document';
import { colourToken } from '../../../shared/panels/colour_token';
import { chosenPart, pointed, view } from '../views';
import type { ZippableSession } from '../zippable_session';

export function PartList({ session }: { session: ZippableSession }) {
  const shown = session.shown.value;
  const failed = session.problem.value?.kind === 'solve' ? session.problem.value.message : null;
  const triangle = pointed.value?.places[0]?.triangle;
  const under = triangle === undefined ? null : shown?.partOfTriangle[triangle];
  return (
    <>
      <DrawRow session={session} />
      {failed ? (
        <p class="part-problem">
          <Icon name="warn" small /> {failed}
        </p>
      ) : null}
      {shown ? (
        <ul class="part-list" aria-label="Parts">
          {shown.design.parts.map(({ windings, period_mm, height_mm }, part) => {
            const distortion = shown.model.distortion[part];
            const warning = partWarning(part, sentences(shown.report, 'notes'), distortion);
            const chosen = chosenPart.value === part;
            return (
              <li key={part}>
                <button
                  type="button"
                  class={under === part ? 'part-row under' : 'part-row'}
                  aria-pressed={chosen}
                  onClick={() => (chosenPart.value = chosen ? null : part)}
                >
                  <i class="part-badge" style={{ '--part': `var(${colourToken(part)})` }} aria-hidden="true">
                    {part + 1}
                  </i>
                  <span class="grow">
                    <span class="part-line">
                      <strong>{partName(part)}</strong>
                      <span>
                        {formatFixed(windings, 1)} windings, {formatNumber(period_mm, 2)} ×{' '}
                        {withUnit(formatNumber(height_mm, 2), 'mm')}
                      </span>
                    </span>
                    <small class={warning ? 'part-warning' : ''}>
                      {warning ?? unwrapWords(distortion)} Distortion {formatFixed(distortion?.mean ?? 1, 2)}
                    </small>
                  </span>
                </button>
                {chosen ? <OwnWindings session={session} part={part} windings={windings} /> : null}
              </li>
            );
          })}
        </ul>
      ) : null}
      {shown && shown.design.order.length > 1 ? (
        <p class="part-order">
          Order of the parts along the zipper:{' '}
          {shown.design.order.map((part, i) => (
            <Fragment key={part}>
              {i > 0 ? ', ' : ''}
              <strong>{part + 1}</strong>
            </Fragment>
          ))}
        </p>
      ) : null}
    </>
  );
}

/** Of the chosen part; empty again, it is as all are. */
function OwnWindings({
  session,
  part,
  windings,
}: {
  session: ZippableSession;
  part: number;
  windings: number;
}) {
  const given = ownWindings(session.value('part_windings'));
  return (
    <div class="own-windings">
      <Parameter
        label={`Windings of part ${part + 1}`}
        help={session.operation.value?.parameters.properties['part_windings']?.description}
        unit=""
        minimum={0.1}
        maximum={1000}
        slider={[1, 20]}
        optional
        automatic={Math.round(10 * windings) / 10}
        integer={false}
        defaultValue={null}
        value={given[part] ? given[part] : null}
        error={session.fieldErrors.value['part_windings']}
        onPreview={(value) => session.preview('part_windings', withOwnWindings(given, part, value))}
        onCommit={() => session.services.projects.commit()}
      />
    </div>
  );
}

function DrawRow({ session }: { session: ZippableSession }) {
  const { borders, openings, cuts } = drawnOn(session.document.value);
  const byHand = borders.length + openings.length + cuts.length > 0;
  const count = (n: number, one: string) => (n === 0 ? [] : [`${n} ${one}${n === 1 ? '' : 's'}`]);
  return (
    <div class="row draw-row">
      <p class="grow">
        {byHand
          ? `Drawn by hand: ${[...count(borders.length, 'border'), ...count(openings.length, 'opening'), ...count(cuts.length, 'cut')].join(', ')}`
          : 'The parts were found automatically'}
      </p>
      {tool.value === null ? (
        <Button
          size="small"
          icon="pencil"
          onClick={() => {
            view.value = 'parts';
            tool.value = 'border';
          }}
        >
          {byHand ? 'Change the drawing' : 'Draw the parts'}
        </Button>
      ) : (
        <Button size="small" icon="check" onClick={() => (tool.value = null)}>
          Done
        </Button>
      )}
    </div>
  );
}
