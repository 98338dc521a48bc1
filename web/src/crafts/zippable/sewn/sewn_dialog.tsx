// SPDX-License-Identifier: GPL-3.0-or-later
// Measure what was sewn, learn what goes wrong in the workshop, and have the next plan make up for it.
import { useSignal } from '@preact/signals';
import { useEffect, useId, useRef } from 'preact/hooks';
import { Button, Dialog, withUnit } from '../../../ui';
import { readDiagnosis } from '../../../shared/diagnosis/diagnosis';
import { sureWords, whyWords } from '../../../shared/diagnosis/diagnosis_words';
import type { ZippableSession } from '../zippable_session';
import { canCheck, checkNow, chooseLengths, diagnoseSewn, isUsed, setSewn, useInPlan } from './check_sewn';
import type { SewnCheck, SewnFinding, SewnLength } from './sewn_lengths';
import { isMeasured, isStrange, lengthsCsv, minLengths, problemOf } from './sewn_lengths';
import './sewn.css';

export function SewnButton({ session }: { readonly session: ZippableSession }) {
  const open = useSignal(false);
  if (!canCheck(session)) return null;
  return (
    <>
      <Button kind="quiet" onClick={() => (open.value = true)}>
        Measure what you sewed
      </Button>
      {open.value ? <SewnDialog session={session} onClose={() => (open.value = false)} /> : null}
    </>
  );
}

function SewnDialog({ session, onClose }: { session: ZippableSession; onClose: () => void }) {
  const check = checkNow(session);
  return (
    <Dialog title="Measure what you sewed" wide onClose={onClose}>
      <div class="sewn">
        {check ? <Check session={session} check={check} /> : <Start session={session} />}
      </div>
    </Dialog>
  );
}

/** What runs, or why it could not. */
function State({ session }: { session: ZippableSession }) {
  const activity = session.activity.value;
  const problem = session.problem.value;
  if (activity.kind !== 'idle') {
    const share = activity.progress?.fraction;
    return (
      <p class="sewn-state" role="status">
        {activity.progress?.stage ?? 'Working'}
        {share === undefined ? '' : `, ${withUnit(String(Math.floor(100 * share)), '%')}`}{' '}
        <Button size="small" onClick={() => session.cancel()}>
          Cancel
        </Button>
      </p>
    );
  }
  return problem ? (
    <p class="sewn-state" role="alert">
      <strong>{problem.title}.</strong> {problem.message}
    </p>
  ) : null;
}

const busyReason = (session: ZippableSession): string | undefined =>
  session.activity.value.kind === 'idle' ? undefined : 'Something else is being made';

function Start({ session }: { session: ZippableSession }) {
  const nothing = session.shown.value === null ? 'Available when the preview is ready' : undefined;
  return (
    <>
      <p>
        Some twenty lengths between the numbered marks tell why a sewn shape is not as designed: a zipper
        wider than planned, cloth that shrank, cloth lost in seams. The next plan then makes up for it.
      </p>
      <ol class="sewn-steps">
        <li>
          <strong>Choose the lengths.</strong> The simulation finds those that tell most.
        </li>
        <li>
          <strong>Measure the flat pieces</strong> after cutting, before they are sewn.
        </li>
        <li>
          <strong>Measure the zipped object</strong> with calipers or a ruler, from zipper to zipper.
        </li>
      </ol>
      <Button
        kind="filled"
        disabledReason={nothing ?? busyReason(session)}
        onClick={() => void chooseLengths(session)}
      >
        Choose the lengths
      </Button>
      <State session={session} />
    </>
  );
}

function Check({ session, check }: { session: ZippableSession; check: SewnCheck }) {
  const measured = check.lengths.filter(isMeasured).length;
  const wrong = check.lengths.some((length) => problemOf(length) !== null);
  const current = check.found !== null && check.found.of === lengthsCsv(check.lengths);
  const missing = minLengths - measured;
  const cannot = wrong
    ? 'Correct the lengths that cannot be read'
    : missing > 0
      ? `At least ${minLengths} lengths are needed; ${missing} more`
      : current
        ? 'These lengths are diagnosed'
        : undefined;
  return (
    <>
      <details class="sewn-outlook">
        <summary>What these lengths show</summary>
        <p>{check.outlook}</p>
      </details>
      <Lengths
        session={session}
        check={check}
        state="flat"
        title="On the flat pieces, before they are sewn"
      />
      <Lengths
        session={session}
        check={check}
        state="zipped"
        title="On the zipped object, straight through it"
      />
      <div class="sewn-actions">
        <Button
          kind={current ? 'outlined' : 'filled'}
          disabledReason={cannot ?? busyReason(session)}
          onClick={() => void diagnoseSewn(session, check)}
        >
          Find out why
        </Button>
        <Button
          kind="quiet"
          disabledReason={busyReason(session)}
          onClick={() => session.services.projects.do(setSewn(null, 'Forget the lengths'))}
        >
          Choose others
        </Button>
        <span>
          {measured} of {check.lengths.length} measured
        </span>
      </div>
      <State session={session} />
      {check.found && current ? <Finding session={session} check={check} found={check.found} /> : null}
    </>
  );
}

interface LengthsProps {
  readonly session: ZippableSession;
  readonly check: SewnCheck;
  readonly state: SewnLength['state'];
  readonly title: string;
}

function Lengths({ session, check, state, title }: LengthsProps) {
  const rows = check.lengths
    .map((length, i) => ({ length, i }))
    .filter(({ length }) => length.state === state);
  if (rows.length === 0) return null;
  const type = (at: number, measured: string) => {
    const lengths = check.lengths.map((length, i) => (i === at ? { ...length, measured } : length));
    session.services.projects.do(setSewn({ ...check, lengths }, 'Type a length', `length ${at}`));
  };
  return (
    <table class="sewn-lengths">
      <caption>{title}</caption>
      <thead>
        <tr>
          <th scope="col">From mark</th>
          <th scope="col">to mark</th>
          <th scope="col">expected</th>
          <th scope="col">measured, mm</th>
        </tr>
      </thead>
      <tbody>
        {rows.map(({ length, i }) => (
          <Row
            key={i}
            length={length}
            onType={(text) => type(i, text)}
            onLeave={() => session.services.projects.commit()}
          />
        ))}
      </tbody>
    </table>
  );
}

interface RowProps {
  readonly length: SewnLength;
  readonly onType: (text: string) => void;
  readonly onLeave: () => void;
}

function Row({ length, onType, onLeave }: RowProps) {
  const id = useId();
  const problem =
    problemOf(length) ?? (isStrange(length) ? 'Far from what is expected: the right marks?' : null);
  return (
    <tr>
      <td>{length.from}</td>
      <td>{length.to}</td>
      <td>{withUnit(length.expected_mm.toFixed(1), 'mm')}</td>
      <td>
        <input
          type="text"
          inputMode="decimal"
          value={length.measured}
          aria-label={`Measured from mark ${length.from} to mark ${length.to}, millimetres`}
          aria-invalid={problemOf(length) !== null}
          aria-describedby={problem ? id : undefined}
          onInput={(event) => onType(event.currentTarget.value)}
          onBlur={onLeave}
        />
        {problem ? (
          <small id={id} class="sewn-problem">
            {problem}
          </small>
        ) : null}
      </td>
    </tr>
  );
}

interface FindingProps {
  readonly session: ZippableSession;
  readonly check: SewnCheck;
  readonly found: SewnFinding;
}

function Finding({ session, check, found }: FindingProps) {
  const diagnosis = readDiagnosis(found.report);
  const { named, causes, reading, alike } = diagnosis;
  const remedies = causes.filter(({ name }) => named.includes(name)).map(({ remedy }) => remedy);
  const tells = alike.map(({ measurement }) => measurement).filter(Boolean);
  const used = isUsed(session, check);
  const ref = useRef<HTMLElement>(null);
  // Below a long list of lengths nobody would see it.
  useEffect(() => ref.current?.scrollIntoView({ block: 'nearest' }), [found]);
  return (
    <section ref={ref} class="sewn-found" aria-label="What was found">
      <h3>What was found</h3>
      <p>{whyWords(diagnosis)}</p>
      {remedies.map((remedy) => (
        <p key={remedy}>{remedy}</p>
      ))}
      {reading === 'cannot_separate' && tells[0] ? <p>To tell which: {tells[0]}</p> : null}
      <p class="sewn-sure">{sureWords(diagnosis).join(' ')}</p>
      {named.length > 0 ? (
        <Button
          kind="filled"
          {...(used ? { icon: 'check' as const } : {})}
          disabledReason={used ? 'Plans of this project make up for it already' : busyReason(session)}
          onClick={() => useInPlan(session, check)}
        >
          {used ? 'Used in the next plan' : 'Use in the next plan'}
        </Button>
      ) : null}
    </section>
  );
}
