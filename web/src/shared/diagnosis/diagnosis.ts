// SPDX-License-Identifier: GPL-3.0-or-later
// What a diagnosis says, read from its report: names and figures are the core's, sentences about readings are ours.
import type { Json, JsonObject, Report } from '../../jobs/contract';
import { isObject } from '../../project/document';
import { formatNumber, withUnit } from '../../ui';
import { figure, sentences } from '../session/report';

export interface Estimate {
  readonly value: number;
  readonly low: number;
  readonly high: number;
}

/** Whose a cause is: what the maker does or has; how it was measured; what the simulation leaves out. */
type FaultOf = 'machine' | 'measurement' | 'simulation';

export interface Cause {
  readonly name: string;
  readonly label: string;
  readonly probability: number;
  /** Without an interval where the cause was not fitted. */
  readonly strength: Estimate;
  readonly unit: string;
  readonly values: Readonly<Record<string, number>>;
  /** What happened, in a sentence; empty where the core has none. */
  readonly inWords: string;
  readonly remedy: string;
  readonly faultOf: FaultOf;
}

/** What may be wrong; the probabilities of all answers add up to 1. */
interface Answer {
  readonly label: string;
  readonly causes: readonly string[];
  readonly probability: number;
}

export interface Gain {
  /** Of objects that were not used at all; else of parts that were left out of the fit. */
  readonly unseen: boolean;
  readonly title: string;
  readonly detail: string;
  readonly before: Estimate;
  readonly after: Estimate;
  readonly share: Estimate;
}

type Reading = 'none' | 'cause' | 'cannot_separate' | 'unknown';

export interface Diagnosis {
  readonly reading: Reading;
  readonly sentence: string;
  /** Why the answer may be wrong, or not all. */
  readonly doubts: readonly string[];
  /** The most probable first; those too small to list are one. */
  readonly answers: readonly Answer[];
  /** Causes that would fit but failed a check, and why. */
  readonly failed: readonly {
    readonly label: string;
    readonly causes: readonly string[];
    readonly why: string;
  }[];
  readonly causes: readonly Cause[];
  readonly named: readonly string[];
  /** Pairs that look alike, with the measurement that would tell. */
  readonly alike: readonly { readonly labels: readonly string[]; readonly measurement: string }[];
  readonly gains: readonly Gain[];
  /** Other quantities than places, such as thickness: mean errors on held-out data. */
  readonly otherQuantities: readonly {
    readonly title: string;
    readonly readings: number;
    readonly before_mm: number;
    readonly after_mm: number;
  }[];
  readonly noiseFloor_mm: number;
  /** Standard deviation of one coordinate, by object. */
  readonly sigma_mm: ReadonlyMap<string, number>;
  readonly parameters: readonly {
    readonly name: string;
    readonly label: string;
    readonly unit: string;
    readonly calibrated: number;
    readonly extended: number;
  }[];
  /** What the simulation was extended by before causes were looked for, and what would make it better still. */
  readonly extensions: readonly {
    readonly included: boolean;
    readonly explanation: string;
    readonly remedy: string;
    readonly before_mm: number;
    readonly after_mm: number;
  }[];
  /** Names of parts from when the machine was in order, that it was compared beside. */
  readonly goodParts: readonly string[];
  readonly notes: readonly string[];
  readonly simulations: number | null;
}

const list = (value: Json | undefined): JsonObject[] => (Array.isArray(value) ? value.filter(isObject) : []);
const text = (value: Json | undefined): string => (typeof value === 'string' ? value : '');
const number = (value: Json | undefined): number =>
  typeof value === 'number' && Number.isFinite(value) ? value : 0;

function estimateOf(value: Json | undefined, interval: Json | undefined): Estimate {
  const middle = number(value);
  const [low, high] = Array.isArray(interval) ? (interval as readonly Json[]) : [];
  return { value: middle, low: number(low ?? middle), high: number(high ?? middle) };
}

function gainOf(source: JsonObject, unseen: boolean, title: string, detail: string): Gain {
  return {
    unseen,
    title,
    detail,
    before: estimateOf(source['error_before_mm'], source['error_before_interval_mm']),
    after: estimateOf(source['error_after_mm'], source['error_after_interval_mm']),
    share: estimateOf(source['gain_share'], source['gain_interval']),
  };
}

/** Probabilities below this are counted together. */
export const minListed = 0.01;

function answersOf(report: Report): Answer[] {
  const all = list(report['answers']).map((answer) => ({
    label: text(answer['label']),
    causes: sentences(answer, 'causes'),
    probability: number(answer['probability']),
  }));
  const listed = all.filter(({ probability }) => probability >= minListed);
  const others = all
    .filter(({ probability }) => probability < minListed)
    .reduce((sum, { probability }) => sum + probability, number(report['other_answers']));
  return others > 0 ? [...listed, { label: 'All other answers', causes: [], probability: others }] : listed;
}

export function readDiagnosis(report: Report): Diagnosis {
  const causes = list(report['causes']).map((cause) => ({
    name: text(cause['name']),
    label: text(cause['label']),
    probability: number(cause['probability']),
    strength: estimateOf(cause['strength'], cause['interval']),
    unit: text(cause['unit']),
    values: Object.fromEntries(
      Object.entries(isObject(cause['values']) ? cause['values'] : {}).map(([name, value]) => [
        name,
        number(value),
      ]),
    ),
    inWords: text(cause['in_words']),
    remedy: text(cause['remedy']),
    faultOf: (text(cause['fault_of']) || 'machine') as FaultOf,
  }));
  const labelOf = (name: string) => causes.find((cause) => cause.name === name)?.label ?? name;
  const unseen = report['unseen'];
  const objects = isObject(unseen) ? sentences(unseen, 'objects') : [];
  return {
    reading: (text(report['reading']) || 'none') as Reading,
    sentence: text(report['sentence']),
    doubts: sentences(report, 'doubts'),
    answers: answersOf(report),
    failed: list(report['failed']).map((one) => ({
      label: text(one['label']),
      causes: sentences(one, 'causes'),
      why: text(one['sentence']),
    })),
    causes,
    named: sentences(report, 'verdict').filter((name) => causes.some((cause) => cause.name === name)),
    alike: list(report['not_separable']).map((pair) => ({
      labels: sentences(pair, 'causes').map(labelOf),
      measurement: text(pair['measurement']),
    })),
    gains: [
      gainOf(report, false, 'Points left out', 'of the fit'),
      ...(isObject(unseen) ? [gainOf(unseen, true, 'Kept for checking', objects.join(', '))] : []),
    ],
    otherQuantities: list(report['other_quantities']).map((one) => ({
      title: text(one['object']),
      readings: number(one['readings']),
      before_mm: number(one['error_before_mm']),
      after_mm: number(one['error_after_mm']),
    })),
    noiseFloor_mm: figure(report, 'noise_floor_mm') ?? 0,
    sigma_mm: new Map(
      list(report['noise']).map((noise) => [text(noise['object']), number(noise['sigma_mm'])]),
    ),
    parameters: list(report['parameters']).map((parameter) => ({
      name: text(parameter['name']),
      label: text(parameter['label']),
      unit: text(parameter['unit']),
      calibrated: number(parameter['calibrated']),
      extended: number(parameter['extended']),
    })),
    extensions: list(report['simulation'])
      .filter((one) => one['taken'] === true || one['advised'] === true)
      .map((one) => ({
        included: one['taken'] === true,
        explanation: text(one['explanation']),
        remedy: text(one['remedy']),
        before_mm: number(one['error_before_mm']),
        after_mm: number(one['error_after_mm']),
      })),
    goodParts: sentences(report, 'good_parts'),
    notes: sentences(report, 'notes'),
    simulations: figure(report, 'simulations'),
  };
}

/** What a reading means for the maker. */
export function readingWords({ reading, alike }: Pick<Diagnosis, 'reading' | 'alike'>): string {
  switch (reading) {
    case 'none':
      return 'Nothing to fix: the remaining error is as small as the measuring noise. The simulation with the calibrated material can be used as it is.';
    case 'unknown':
      return 'The measurement differs in a systematic way that none of the known causes explains. Look for other causes.';
    case 'cannot_separate': {
      const labels = alike[0]?.labels ?? [];
      return labels.length === 2
        ? `“${labels[0]}” and “${labels[1]}” explain this measurement equally well.`
        : 'More than one cause explains this measurement equally well.';
    }
    case 'cause':
      return '';
  }
}

/** "87 %"; never 0 or 100, which nobody knows. */
export function percent(probability: number): string {
  if (probability > 0.995) return withUnit('> 99', '%');
  if (probability < 0.005) return withUnit('< 1', '%');
  return withUnit(String(Math.round(100 * probability)), '%');
}

/** "0.40 ± 0.01 mm": as many digits as the doubt leaves. */
export function formatEstimate(estimate: Estimate, unit: string): string {
  const doubt = doubtOf(estimate);
  if (!(doubt > 0)) return withUnit(formatNumber(estimate.value), unit);
  return withUnit(`${rounded(estimate.value, doubt)} ± ${rounded(doubt, doubt)}`, unit);
}

/** "0.60°" of a quantity that is part of `whole`, as the angle about one axis is of a turn: no more digits than the whole
 *  has. */
export function formatPart(value: number, whole: Estimate, unit: string): string {
  const doubt = doubtOf(whole);
  return withUnit(doubt > 0 ? rounded(value, doubt) : formatNumber(value), unit);
}

const doubtOf = ({ low, high }: Estimate): number => (high - low) / 2;

function rounded(value: number, doubt: number): string {
  const decimals = Math.min(6, Math.max(0, -Math.floor(Math.log10(doubt))));
  const digits = Math.abs(value).toFixed(decimals);
  return value < 0 && Number(digits) > 0 ? `\u2212${digits}` : digits;
}

/** How many times more probable the data are with a cause than without any, as a power of ten; null where the report does
 *  not tell. */
export function oddsAgainstNone(report: Report, name: string): number | null {
  const hypotheses = list(report['hypotheses']);
  const evidenceOf = (fits: (causes: readonly string[]) => boolean): number =>
    Math.max(
      ...hypotheses.filter((one) => fits(sentences(one, 'causes'))).map((one) => number(one['log_evidence'])),
    );
  const difference =
    evidenceOf((causes) => causes.includes(name)) - evidenceOf((causes) => causes.length === 0);
  return Number.isFinite(difference) ? difference / Math.LN10 : null;
}
