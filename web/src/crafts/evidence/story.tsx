// SPDX-License-Identifier: GPL-3.0-or-later
// A diagnosis in five steps: how far off, where, why, what to do, how sure; and what our simulation left out, where it did.
import type { ComponentChildren } from 'preact';
import { Button, formatNumber, withUnit } from '../../ui';
import type { Diagnosis } from '../../shared/diagnosis/diagnosis';
import { extensionWords, goodPartWords, sureWords, whyWords } from '../../shared/diagnosis/diagnosis_words';
import type { EvidenceSession } from './evidence_session';
import type { Residuals } from './pictures/residuals';
import { minPrintPoints } from './pictures/print_picture';
import { distancesOf, meanOf, movedBy, worstRegion } from './pictures/residuals';
import { view } from './view_choice';

const length = (value_mm: number): string => withUnit(formatNumber(value_mm, 2), 'mm');

export function Story({ session, diagnosis }: { session: EvidenceSession; diagnosis: Diagnosis }) {
  const look = session.look.value;
  const residuals = look?.kind === 'diagnosis' ? look.residuals : null;
  return (
    <section class="section" aria-label="What was found">
      <h3>What was found</h3>
      <ol class="story">
        <Step title="How far off">
          {residuals
            ? `Measured and simulated sheet are ${length(meanOf(distancesOf(residuals, 'base')))} apart on average, with the material calibrated. Noise alone would leave ${length(diagnosis.noiseFloor_mm)}.`
            : `Noise alone would leave ${length(diagnosis.noiseFloor_mm)}.`}
          {diagnosis.goodParts.length > 0
            ? ` What the simulation misses of the good part ${diagnosis.goodParts.join(', ')} is not counted.`
            : ''}
        </Step>
        {residuals ? <Step title="Where">{whereWords(residuals)}</Step> : null}
        {diagnosis.extensions.length > 0 ? (
          <Step title="What our simulation left out">
            {extensionWords(diagnosis).map((sentence) => (
              <span key={sentence} class="story-line">
                {sentence}
              </span>
            ))}
          </Step>
        ) : null}
        <Step title="Why">{whyWords(diagnosis)}</Step>
        <Step title="What to do">
          {todo(diagnosis).map((sentence) => (
            <span key={sentence} class="story-line">
              {sentence}
            </span>
          ))}
          {residuals && diagnosis.named.length > 0 ? (
            <>
              {printWords(residuals, diagnosis)}
              {residuals.count >= minPrintPoints ? (
                <Button size="small" class="story-look" onClick={() => (view.value = 'print')}>
                  See the print before and after
                </Button>
              ) : null}
            </>
          ) : null}
        </Step>
        <Step title="How sure">
          {[...sureWords(diagnosis), ...goodPartWords(diagnosis)].map((sentence) => (
            <span key={sentence} class="story-line">
              {sentence}
            </span>
          ))}
        </Step>
      </ol>
    </section>
  );
}

function Step({ title, children }: { title: string; children: ComponentChildren }) {
  return (
    <li>
      <h4>{title}</h4>
      <p>{children}</p>
    </li>
  );
}

function whereWords(residuals: Residuals): string {
  const worst = worstRegion(residuals, 'base');
  return worst === null
    ? 'The points lie too close together to say.'
    : `Most ${worst.where}, ${length(worst.mean_mm)} on average there.`;
}

function todo({ reading, named, causes }: Diagnosis): string[] {
  if (reading === 'none') return ['Nothing: use the calibrated material for the next print.'];
  if (reading === 'unknown')
    return [
      'Nothing is advised for a cause that does not explain the data. Measure a second object of another shape.',
    ];
  return causes.filter(({ name }) => named.includes(name)).map(({ remedy }) => remedy);
}

function printWords(residuals: Residuals, { named, causes }: Diagnosis): string {
  const moved = movedBy(residuals);
  const machineIsWell = causes.every(
    ({ name, faultOf }) => !named.includes(name) || faultOf === 'simulation',
  );
  return moved === null
    ? ''
    : `${machineIsWell ? 'The' : 'Or print for the machine as it is: the'} simulation with this cause puts the features of the next print ${length(moved.mean_mm)} elsewhere on average, up to ${length(moved.largest_mm)}.`;
}
