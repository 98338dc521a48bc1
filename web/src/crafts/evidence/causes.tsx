// SPDX-License-Identifier: GPL-3.0-or-later
// Ranked causes, each with its strength; opened, what it is, what speaks for it and what to do.
import { useSignal } from '@preact/signals';
import { useId } from 'preact/hooks';
import { Icon, formatNumber } from '../../ui';
import type { Cause, Diagnosis } from '../../shared/diagnosis/diagnosis';
import {
  formatEstimate,
  formatPart,
  minListed,
  oddsAgainstNone,
  percent,
} from '../../shared/diagnosis/diagnosis';
import type { EvidenceSession } from './evidence_session';
import { comparing } from './evidence_document';

export function Causes({ session, diagnosis }: { session: EvidenceSession; diagnosis: Diagnosis }) {
  const { answers, causes, reading, named, alike } = diagnosis;
  const shown = causes.filter(({ name, probability }) => named.includes(name) || probability >= minListed);
  return (
    <section class="section causes" aria-label="Causes of the difference">
      <h3>Causes of the difference</h3>
      {reading === 'none' || reading === 'unknown' ? <p class="reading">{diagnosis.sentence}</p> : null}
      {answers.length > 0 ? (
        <ol class="answers" aria-label="What it may be">
          {answers.map(({ label, probability }) => (
            <li key={label}>
              <span class="cause-line">
                <span>{label}</span>
                <b>{percent(probability)}</b>
              </span>
              <span class="progress" aria-hidden="true">
                <i style={{ width: `${100 * probability}%` }} />
              </span>
            </li>
          ))}
        </ol>
      ) : null}
      <ol>
        {shown.map((cause) => (
          <CauseCard key={cause.name} session={session} cause={cause} named={named.includes(cause.name)} />
        ))}
      </ol>
      <NotNeeded diagnosis={diagnosis} shown={shown} />
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

/** What was checked and is not believed: folded, without figures that would look as if something were wrong. */
function NotNeeded({ diagnosis, shown }: { diagnosis: Diagnosis; shown: readonly Cause[] }) {
  const open = useSignal(false);
  const id = useId();
  const failedAlone = diagnosis.failed
    .filter(({ causes }) => causes.length === 1)
    .flatMap(({ causes }) => causes);
  const rest = diagnosis.causes.filter(
    ({ name }) => !failedAlone.includes(name) && !shown.some((one) => one.name === name),
  );
  const rows = [
    ...diagnosis.failed,
    ...rest.map(({ label }) => ({ label, why: 'It fits worse than the answers above.' })),
  ];
  if (rows.length === 0) return null;
  return (
    <>
      <button
        type="button"
        class="text-button"
        aria-expanded={open.value}
        aria-controls={id}
        onClick={() => (open.value = !open.value)}
      >
        <Icon name={open.value ? 'chevronDown' : 'chevronRight'} small /> Checked and not needed:{' '}
        {rows.length}
      </button>
      <dl id={id} class="not-needed" hidden={!open.value}>
        {rows.map(({ label, why }) => (
          <div key={label}>
            <dt>{label}</dt>
            <dd>{why}</dd>
          </div>
        ))}
      </dl>
    </>
  );
}

const faultTitles = {
  machine: 'At your machine',
  measurement: 'In your measurement',
  simulation: 'In our simulation',
} as const;

function CauseCard({ session, cause, named }: { session: EvidenceSession; cause: Cause; named: boolean }) {
  const open = useSignal(false);
  const id = useId();
  return (
    <li class={named ? 'cause named' : 'cause'}>
      <button
        type="button"
        aria-expanded={open.value}
        aria-controls={id}
        onClick={() => (open.value = !open.value)}
      >
        <strong>{cause.label}</strong>
        <small class="fault-of">{faultTitles[cause.faultOf]}</small>
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
            <dd>{formatPart(value, cause.strength, properties[name]?.['x-unit'] ?? '')}</dd>
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
