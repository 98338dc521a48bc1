// SPDX-License-Identifier: GPL-3.0-or-later
// A diagnosis as sentences: why, and how sure.
import { formatNumber, withUnit } from '../../ui';
import type { Diagnosis, Gain } from './diagnosis';
import { percent, readingWords } from './diagnosis';

const length = (value_mm: number): string => withUnit(formatNumber(value_mm, 2), 'mm');

/** One sentence for each named cause. */
export function whyWords(diagnosis: Diagnosis): string {
  const { named, causes, reading } = diagnosis;
  if (reading === 'none' || reading === 'unknown') return readingWords(diagnosis);
  const sentences = named.flatMap((name) => {
    const cause = causes.find((one) => one.name === name);
    return cause ? [cause.inWords || `${cause.label}.`] : [];
  });
  return [...sentences, readingWords(diagnosis)].filter(Boolean).join(' ');
}

/** Some sentences for each thing that the simulation left out and now includes, or could include. */
export const extensionWords = ({ extensions }: Diagnosis): string[] =>
  extensions.map(
    ({ included, explanation, remedy, before_mm, after_mm }) =>
      `${explanation} ${
        included
          ? 'Our usual simulation leaves that out; it is included here, and the calibrated error'
          : 'It is not included here, since it takes longer: with it and nothing else changed, the error'
      } is ${length(after_mm)} instead of ${length(before_mm)}. ${remedy}`,
  );

const gainWords = ({ unseen, before, after }: Gain): string =>
  `${unseen ? 'On the object kept for checking' : 'On points that were left out of the fit'}, the error ${
    after.value < before.value ? 'falls' : 'goes'
  } from ${length(before.value)} to ${length(after.value)}.`;

const quantityWords = ({
  title,
  readings,
  before_mm,
  after_mm,
}: Diagnosis['otherQuantities'][number]): string =>
  `${title}, ${readings} ${readings === 1 ? 'reading' : 'readings'}: the error ${
    after_mm < before_mm ? 'falls' : 'goes'
  } from ${length(before_mm)} to ${length(after_mm)}.`;

/** The most probable answer, what was not used for the fit, and what speaks against it. */
export function sureWords({ answers, gains, otherQuantities, doubts, reading }: Diagnosis): string[] {
  const first = answers[0];
  return [
    ...(first ? [`${percent(first.probability)} for “${first.label}”.`] : []),
    ...(reading === 'none' ? [] : [...gains.map(gainWords), ...otherQuantities.map(quantityWords)]),
    ...doubts,
  ];
}

/** What would tell more, where the answer is unknown or in doubt and no good part was given; else nothing. */
export const goodPartWords = ({ goodParts, reading, doubts }: Diagnosis): string[] =>
  goodParts.length === 0 && (reading === 'unknown' || doubts.length > 0)
    ? [
        'If you have a part over the same mould from when all was in order, measure it, too, and mark it as “Good part”: it shows what has changed.',
      ]
    : [];
