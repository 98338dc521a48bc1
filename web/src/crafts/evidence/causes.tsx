// SPDX-License-Identifier: GPL-3.0-or-later
// Ranked causes, each with its strength; opened, what it is, what speaks for it and what to do.
import { useSignal } from '@preact/signals';
import { useId } from 'preact/hooks';
import { Icon, formatNumber, withUnit } from '../../ui';
import type { Cause, Diagnosis } from './diagnosis';
import { formatEstimate, oddsAgainstNone, percent, readingWords } from './diagnosis';
import type { EvidenceSession } from './evidence_session';
import { comparing } from './evidence_document';

const shownCauses = 3;

export function Causes({ session, diagnosis }: { session: EvidenceSession; diagnosis: Diagnosis }) {
  const all = useSignal(false);
  const { causes, reading, named, alike } = diagnosis;
  const words = readingWords(diagnosis);
  const certain = causes.filter(({ name, probability }) => named.includes(name) && probability > 0.995);
  // Where nothing is wrong, a list of causes with figures would look as if something were.
  const shown = reading === 'none' ? 0 : shownCauses;
  const listed = all.value ? causes : causes.slice(0, shown);
  const rest = causes.length - listed.length;
  return (
    <section class="section causes" aria-label="Causes of the difference">
      <h3>Causes of the difference</h3>
      {reading === 'none' || reading === 'unknown' ? <p class="reading">{diagnosis.sentence}</p> : null}
      {words ? <p>{words}</p> : null}
      {certain.length > 1 ? <p>Found together, each almost certain.</p> : null}
      <ol>
        {listed.map((cause) => (
          <CauseCard key={cause.name} session={session} cause={cause} named={named.includes(cause.name)} />
        ))}
        {diagnosis.unlisted >= 0.005 && reading !== 'none' ? (
          <li class="cause unlisted">
            <span class="cause-line">
              A cause that is not in the list <b>{percent(diagnosis.unlisted)}</b>
            </span>
          </li>
        ) : null}
      </ol>
      {rest > 0 ? (
        <button type="button" class="text-button" onClick={() => (all.value = true)}>
          {reading === 'none' ? 'Checked and not needed: ' : 'Show '}
          {rest} {reading === 'none' ? '' : 'less likely '}
          {rest === 1 ? 'cause' : 'causes'}
        </button>
      ) : null}
      {alike
        .filter(({ measurement }) => measurement !== '')
        .map(({ labels, measurement }) => (
          <p key={labels.join()}>
            <strong>To tell “{labels.join('” from “')}”:</strong> {measurement}
          </p>
        ))}
    </section>
  );
}

function CauseCard({ session, cause, named }: { session: EvidenceSession; cause: Cause; named: boolean }) {
  const open = useSignal(false);
  const id = useId();
  const probability = percent(cause.probability);
  return (
    <li class={named ? 'cause named' : 'cause'}>
      <button
        type="button"
        aria-expanded={open.value}
        aria-controls={id}
        onClick={() => (open.value = !open.value)}
      >
        <span class="cause-line">
          <strong>{cause.label}</strong>
          <b>{probability}</b>
        </span>
        {named ? (
          <span class="progress" aria-hidden="true">
            <i style={{ width: `${100 * cause.probability}%` }} />
          </span>
        ) : null}
        <span class="cause-line">
          <span>
            <Icon name={open.value ? 'chevronDown' : 'chevronRight'} small /> Strength
          </span>
          <span>{formatEstimate(cause.strength, cause.unit)}</span>
        </span>
      </button>
      <div id={id} hidden={!open.value}>
        {open.value ? <Details session={session} cause={cause} /> : null}
      </div>
    </li>
  );
}

function Details({ session, cause }: { session: EvidenceSession; cause: Cause }) {
  const properties = session.operationNamed(comparing)?.parameters.properties ?? {};
  const odds = oddsAgainstNone(session.result.value?.report ?? {}, cause.name);
  return (
    <>
      <dl>
        {Object.entries(cause.values).map(([name, value]) => (
          <div key={name}>
            <dt>
              {properties[name]?.title ?? name}
              {properties[name]?.description ? <small>{properties[name].description}</small> : null}
            </dt>
            <dd>{withUnit(formatNumber(value), properties[name]?.['x-unit'] ?? '')}</dd>
          </div>
        ))}
      </dl>
      {odds === null ? null : (
        <p>
          <strong>Evidence.</strong>{' '}
          {odds >= 6
            ? 'Without this cause, the calibrated material alone hardly explains the measurement at all.'
            : odds >= 0.3
              ? `The measurement is ${timesWords(odds)} more probable with this cause than with the calibrated material alone.`
              : 'The measurement is no more probable with this cause than with the calibrated material alone.'}{' '}
          The strength is given with its 95 % interval.
        </p>
      )}
      {cause.remedy ? (
        <p>
          <strong>What to do.</strong> {cause.remedy}
        </p>
      ) : null}
    </>
  );
}

const timesWords = (odds: number): string =>
  odds < 3 ? `about ${formatNumber(10 ** odds, 1)} times` : 'thousands of times';
